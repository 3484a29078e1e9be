// Whether a core is a thread's alone.
#include "core_watch.h"

#include <gtest/gtest.h>

#include <iostream>

#include "clock.h"

namespace carom_bench {
namespace {

constexpr double kMinute = 6e10;  // ns

// A core that another thread works on when it is said so.
struct Core {
  bool shared = false;
  int looks = 0;
  int leaves_after = -1;  // looks; -1: never

  double operator()() {
    if (++looks == leaves_after) shared = false;
    return shared ? 0.36 : 0.18;
  }
};

TEST(CoreWatch, WaitsUntilTheOtherThreadLeaves) {
  Core core;
  CoreWatch watch(kMinute, [&core] { return core(); });
  core.shared = true;
  EXPECT_FALSE(watch.alone(watch.look()));
  core.leaves_after = core.looks + 1000;
  EXPECT_TRUE(watch.alone(watch.wait()));
  EXPECT_EQ(core.looks, core.leaves_after);
}

TEST(CoreWatch, WaitsNoLongerThanItsPatienceInAll) {
  Core core;
  CoreWatch watch(2e7, [&core] { return core(); });
  core.shared = true;
  const Stopwatch stopwatch;
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(watch.alone(watch.wait()));
  std::cout << stopwatch.spent().ns / 1e6 << " ms waited, of 20\n";
  EXPECT_GE(stopwatch.spent().ns, 2e7);
  EXPECT_LT(stopwatch.spent().ns, 1e10);  // each as patient, they would wait 20 s
}

TEST(CoreWatch, CallsNoCoreSharedThatItNeverSawAlone) {
  Core core;
  core.shared = true;
  CoreWatch watch(kMinute, [&core] { return core(); });
  const double beside = watch.wait();
  EXPECT_TRUE(watch.alone(beside));
  core.shared = false;
  EXPECT_TRUE(watch.alone(watch.look()));
  EXPECT_FALSE(watch.alone(beside));  // now it is known better
}

TEST(CoreWatch, AnOperationTakesAtMostAClock) {
  const double clocks = clocks_per_operation();
  std::cout << clocks << " clocks an operation\n";
  EXPECT_GT(clocks, 0.02);
  EXPECT_LE(clocks, 2.0);  // 1 on the narrowest core; twice that beside another thread
}

}  // namespace
}  // namespace carom_bench
