// carom_bench's `run` alone, for machines on which its libraries are not at hand: an emulated one.
#include <cstring>
#include <exception>
#include <iostream>

#include "commands.h"

int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "usage: run_rows KERNEL CASES OUT [--batch]\n";
    return 2;
  }
  carom_bench::Run options;
  options.kernel = argv[1];
  options.cases = argv[2];
  options.out = argv[3];
  options.batch = argc > 4 && std::strcmp(argv[4], "--batch") == 0;
  try {
    carom_bench::run(options);
  } catch (const std::exception& error) {
    std::cerr << "run_rows: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
