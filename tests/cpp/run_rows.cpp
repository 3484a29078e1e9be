// carom_bench's `run` alone, for machines on which its libraries are not at hand: an emulated one.
#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include "commands.h"

namespace {

carom_bench::Run options_of(int argc, char** argv) {
  carom_bench::Run options;
  options.kernel = argv[1];
  options.cases = argv[2];
  options.out = argv[3];
  for (int i = 4; i < argc; ++i) {
    const std::string word = argv[i];
    const bool more = i + 1 < argc;
    if (word == "--batch") {
      options.batch = true;
    } else if (word == "--steps" && more) {
      options.steps = std::atoi(argv[++i]);
    } else if (word == "--trace" && more) {
      options.trace = argv[++i];
    } else {
      throw std::runtime_error("no option " + word);
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "usage: run_rows KERNEL CASES OUT [--batch] [--steps N] [--trace FILE]\n";
    return 2;
  }
  try {
    carom_bench::run(options_of(argc, argv));
  } catch (const std::exception& error) {
    std::cerr << "run_rows: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
