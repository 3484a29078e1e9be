#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "case_rows.h"
#include "clock.h"
#include "commands.h"
#include "core_watch.h"
#include "kernel_library.h"
#include "timing.h"
#include "workload.h"

namespace carom_bench {
namespace {

using Json = nlohmann::json;
using Libraries = std::vector<std::unique_ptr<KernelLibrary>>;

constexpr std::size_t kUnit = 16;  // cases in the smallest window
constexpr std::size_t kSeedRounds =
    1024;  // orders of the seed cases, as a predictor must not learn
constexpr std::uint64_t kSeed = 20140158;
constexpr double kPatience = 0.5;  // of the seconds: as long it goes on for a core that is alone
constexpr double kMostly = 0.8;    // of a round's blocks had the core alone: it was quiet

struct PlannedKernel {
  std::string name, library;
  bool batch, latency;
};

struct Plan {
  std::string cases, seed_cases;
  std::vector<PlannedKernel> kernels;
  std::size_t baseline, rounds;
  double seconds, block_ms;
};

Plan parse_plan(const Json& json) {
  Plan plan{};
  plan.cases = json.at("cases").get<std::string>();
  const Json seed_cases = json.value("seed_cases", Json());
  if (!seed_cases.is_null()) plan.seed_cases = seed_cases.get<std::string>();
  for (const Json& kernel : json.at("kernels")) {
    plan.kernels.push_back({kernel.at("name").get<std::string>(),
                            kernel.at("library").get<std::string>(), kernel.value("batch", false),
                            kernel.value("latency", false)});
  }
  plan.baseline = json.at("baseline").get<std::size_t>();
  plan.rounds = json.at("rounds").get<std::size_t>();
  plan.seconds = json.at("seconds").get<double>();
  plan.block_ms = json.value("block_ms", 1.0);
  return plan;
}

void check_plan(const Plan& plan) {
  if (plan.baseline >= plan.kernels.size()) {
    throw std::runtime_error("baseline is not the index of a kernel");
  }
  if (plan.rounds == 0) throw std::runtime_error("rounds: expected at least 1");
  const bool positive = plan.seconds > 0 && plan.block_ms > 0;
  if (!positive || !std::isfinite(plan.block_ms)) {
    throw std::runtime_error("seconds, block_ms: expected numbers above 0");
  }
}

Plan read_plan(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read; expected a plan in JSON");
  try {
    const Plan plan = parse_plan(Json::parse(file));
    check_plan(plan);
    return plan;
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

// A comparison and which kernel of the plan each entrant is.
struct Measured {
  std::vector<std::size_t> kernels;
  std::unique_ptr<Comparison> comparison;
};

Measured compare(const Plan& plan, const Libraries& libraries, std::vector<std::size_t> kernels,
                 bool latency, Workload* workload, CoreWatch* core) {
  std::vector<Entrant> entrants;
  std::size_t baseline = 0;
  for (std::size_t k : kernels) {
    if (k == plan.baseline) baseline = entrants.size();
    const Mode mode = latency                 ? Mode::kLatency
                      : plan.kernels[k].batch ? Mode::kBatch
                                              : Mode::kThroughput;
    entrants.push_back({plan.kernels[k].name, libraries[k].get(), mode});
  }
  auto comparison = std::make_unique<Comparison>(std::move(entrants), baseline, workload, core,
                                                 plan.block_ms * 1e6);
  return {std::move(kernels), std::move(comparison)};
}

std::vector<std::size_t> all_kernels(const Plan& plan) {
  std::vector<std::size_t> kernels(plan.kernels.size());
  std::iota(kernels.begin(), kernels.end(), std::size_t{0});
  return kernels;
}

// With the baseline, unless nobody asks for latency.
std::vector<std::size_t> latency_kernels(const Plan& plan) {
  std::vector<std::size_t> kernels;
  bool wanted = false;
  for (std::size_t k = 0; k < plan.kernels.size(); ++k) {
    wanted = wanted || plan.kernels[k].latency;
    if (plan.kernels[k].latency || k == plan.baseline) kernels.push_back(k);
  }
  return wanted ? kernels : std::vector<std::size_t>();
}

bool is_quiet(std::size_t round, const std::vector<Measured*>& all, const CoreWatch& core) {
  std::size_t alone = 0, blocks = 0;
  for (const Measured* each : all) {
    for (const Series& series : each->comparison->series()) {
      alone += core.alone(series.looks[round]) ? 1 : 0;
      ++blocks;
    }
  }
  return static_cast<double>(alone) >= kMostly * static_cast<double>(blocks);
}

// By the least look until now, so that what it says of earlier rounds may change.
std::vector<bool> quiet_rounds(std::size_t rounds, const std::vector<Measured*>& all,
                               const CoreWatch& core) {
  std::vector<bool> quiet;
  for (std::size_t round = 0; round < rounds; ++round) quiet.push_back(is_quiet(round, all, core));
  return quiet;
}

// Rounds done until the plan's rounds or seconds are used up. Beyond its rounds it goes on until so
// many were quiet, as long as the patience lasts.
std::size_t run_rounds(const Plan& plan, const std::vector<Measured*>& all, const CoreWatch& core) {
  const Stopwatch watch;
  std::size_t round = 0;
  const auto wanted = [&] {
    const double share = watch.spent().ns / (plan.seconds * 1e9);
    if (round < plan.rounds) return round == 0 || share < 1;
    if (share >= kPatience) return false;
    const std::vector<bool> quiet = quiet_rounds(round, all, core);
    return std::count(quiet.begin(), quiet.end(), true) < static_cast<std::ptrdiff_t>(plan.rounds);
  };
  for (; wanted(); ++round) {
    for (Measured* each : all) each->comparison->round(round);
  }
  return round;
}

Json series_json(const std::string& name, const Series& series) {
  return {{"name", name},
          {"window", series.window},
          {"ns_per_collision", series.ns},
          {"looks", series.looks},
          {"tsc_cycles_per_collision", series.ticks}};
}

Json measured_json(const Measured& measured) {
  if (!measured.comparison) return nullptr;
  const std::vector<Entrant>& entrants = measured.comparison->entrants();
  const std::vector<Series>& series = measured.comparison->series();
  Json kernels = Json::array();
  for (std::size_t i = 0; i < measured.kernels.size(); ++i) {
    Json kernel = series_json(entrants[i].name, series[i]);
    kernel["index"] = measured.kernels[i];
    kernels.push_back(kernel);
  }
  return {{"kernels", kernels}, {"control", series_json(entrants.back().name, series.back())}};
}

double tsc_ghz() {
  const Stopwatch watch;
  while (watch.spent().ns < 5e6) {
  }
  const Spent spent = watch.spent();
  return spent.ticks / spent.ns;
}

void write_json(const std::string& path, const Json& json) {
  const std::string text = json.dump() + '\n';
  write_file(path, text.data(), text.size());
}

Libraries open_libraries(const Plan& plan) {
  Libraries libraries;
  for (const PlannedKernel& kernel : plan.kernels) {
    libraries.push_back(std::make_unique<KernelLibrary>(kernel.library));
  }
  return libraries;
}

}  // namespace

void time_plan(const Time& options) {
  const Plan plan = read_plan(options.plan);
  const Libraries libraries = open_libraries(plan);
  const int cpu = pin_to_one_cpu();
  CoreWatch core(kPatience * plan.seconds * 1e9);
  Workload mixed(shuffled(read_case_rows(plan.cases), kSeed), kUnit);
  std::unique_ptr<Workload> seeds;
  Measured throughput = compare(plan, libraries, all_kernels(plan), false, &mixed, &core);
  Measured latency, seed_cases;
  const std::vector<std::size_t> fed = latency_kernels(plan);
  if (!fed.empty()) latency = compare(plan, libraries, fed, true, &mixed, &core);
  if (!plan.seed_cases.empty()) {
    const std::vector<CaseRow> rows = read_case_rows(plan.seed_cases);
    seeds =
        std::make_unique<Workload>(shuffled_again_and_again(rows, kSeedRounds, kSeed), rows.size());
    seed_cases = compare(plan, libraries, all_kernels(plan), false, seeds.get(), &core);
  }
  std::vector<Measured*> all;
  for (Measured* each : {&throughput, &latency, &seed_cases}) {
    if (each->comparison) all.push_back(each);
  }
  const std::size_t rounds = run_rounds(plan, all, core);
  write_json(options.result, {{"schema", 1},
                              {"cpu", cpu},
                              {"rounds", rounds},
                              {"quiet", quiet_rounds(rounds, all, core)},
                              {"cases", mixed.size()},
                              {"baseline", plan.baseline},
                              {"tsc_ghz", tsc_ghz()},
                              {"core_ghz", core_ghz()},
                              {"throughput", measured_json(throughput)},
                              {"latency", measured_json(latency)},
                              {"seed_cases", measured_json(seed_cases)}});
}

}  // namespace carom_bench
