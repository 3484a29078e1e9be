// carom_bench: makes cases, says what must come out of them, runs kernels on them and times them.
#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <iostream>
#include <string>

#include "case_rows.h"
#include "commands.h"

namespace {

using carom_bench::Expect;
using carom_bench::kCaseColumns;
using carom_bench::kOutcomes;
using carom_bench::MakeCases;
using carom_bench::Run;
using carom_bench::Threads;
using carom_bench::Time;

void add_cases(CLI::App* app, MakeCases* options) {
  CLI::App* sub = app->add_subcommand(
      "cases", "Write random cases: rows of " + std::to_string(kCaseColumns) + " float64.");
  auto* mixed = sub->add_flag("--mixed", options->mixed, "real shots and hard kinds (the default)");
  sub->add_flag_callback(
         "--random", [options] { options->mixed = false; }, "all kinds in turn")
      ->excludes(mixed);
  sub->add_option("--seed", options->seed, "seed of the random numbers")->required();
  sub->add_option("--count", options->count, "number of cases")
      ->required()
      ->check(CLI::Range(1, 100000000));
  sub->add_option("--out", options->out, "file to write")->required();
  sub->add_option("--kinds", options->kinds, "file for the kinds, one a line");
  sub->add_option("--fix", options->fixed, "a parameter for all, as R=0.028575; repeatable");
  sub->callback([options] { carom_bench::make_cases(*options); });
}

void add_expect(CLI::App* app, Expect* options) {
  CLI::App* sub = app->add_subcommand(
      "expect", "What must come out: rows of " + std::to_string(kOutcomes + 2) + " float64 (" +
                    std::to_string(kOutcomes) + " velocities, status, sticks).");
  sub->add_option("--cases", options->cases, "file of cases")->required();
  sub->add_option("--method", options->asked.method, "exact, screen or euler")->required();
  sub->add_option("--model", options->asked.model, "contact model")->required();
  sub->add_option("--steps", options->asked.steps, "steps of euler");
  sub->add_option("--set", options->more, "what else is known, as mass_ratio=2; repeatable");
  sub->add_option("--out", options->out, "file to write")->required();
  sub->add_option("--threads", options->threads, "threads; 0: one a core");
  sub->callback([options] { carom_bench::expect(*options); });
}

void add_run(CLI::App* app, Run* options) {
  CLI::App* sub = app->add_subcommand(
      "run", "Run a kernel: rows of " + std::to_string(kOutcomes + 1) + " float64 (" +
                 std::to_string(kOutcomes) + " velocities, status).");
  sub->add_option("--kernel", options->kernel, "shared library")->required();
  sub->add_option("--cases", options->cases, "file of cases")->required();
  sub->add_option("--out", options->out, "file to write")->required();
  sub->add_option("--steps", options->steps, "fixed steps other than the kernel's own");
  sub->add_flag("--batch", options->batch, "through the batch function");
  sub->add_flag("--in-place", options->in_place, "the outcome overwrites the input");
  sub->add_option("--trace", options->trace, "file for the blocks that ran; of a library with one");
  sub->callback([options] { carom_bench::run(*options); });
}

void add_time(CLI::App* app, Time* options) {
  CLI::App* sub = app->add_subcommand("time", "Time the kernels of a plan against each other.");
  sub->add_option("--plan", options->plan, "plan in JSON")->required();
  sub->add_option("--out", options->result, "file to write, JSON")->required();
  sub->callback([options] { carom_bench::time_plan(*options); });
}

void add_threads(CLI::App* app, Threads* options) {
  CLI::App* sub = app->add_subcommand("threads", "Share a batch over threads: how that scales.");
  sub->add_option("--kernel", options->kernel, "shared library")->required();
  sub->add_option("--cases", options->cases, "file of cases")->required();
  sub->add_option("--count", options->count, "collisions in the batch")
      ->check(CLI::Range(1, 100000000));
  sub->add_option("--rounds", options->rounds, "the best of them counts")
      ->check(CLI::Range(1, 1000));
  sub->add_option("--most", options->most, "threads; 0: one a core");
  sub->callback([options] { carom_bench::threads(*options); });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Makes cases, runs kernels on them, times kernels.");
  app.require_subcommand(1);
  MakeCases cases;
  Expect expect;
  Run run;
  Time time;
  Threads threads;
  add_cases(&app, &cases);
  add_expect(&app, &expect);
  add_run(&app, &run);
  add_time(&app, &time);
  add_threads(&app, &threads);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "carom_bench: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
