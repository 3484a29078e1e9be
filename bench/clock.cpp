#include "clock.h"

#if defined(__linux__)
#include <sched.h>
#endif

namespace carom_bench {

int pin_to_one_cpu() {
#if defined(__linux__)
  const int cpu = sched_getcpu();
  if (cpu < 0 || cpu >= CPU_SETSIZE) return -1;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  return sched_setaffinity(0, sizeof(set), &set) == 0 ? cpu : -1;
#else
  return -1;
#endif
}

}  // namespace carom_bench
