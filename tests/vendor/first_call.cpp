// Many threads make the first call at once; to be built with -fsanitize=thread.
#include <cstdio>
#include <thread>
#include <vector>

#include "carom.hpp"

int main() {
  const carom::Parameters p = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95};
  std::vector<carom::Result> results(8);
  std::vector<std::thread> threads;
  for (carom::Result& result : results) {
    threads.emplace_back([&p, &result] {
      carom::Ball cue, object;
      cue.velocity = {0.1, 1.0, 0.0};
      object.position = {0.02, 0.0535, 0.0};
      carom::use_target("x86-64-v2");
      result = carom::collide(p, cue, object);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const carom::Result& result : results) {
    if (!result || result.ball2.velocity.y != results[0].ball2.velocity.y) return 1;
  }
  std::printf("%zu threads agree\n", results.size());
  return 0;
}
