#include "core/application.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <thread>

#include "core/filling.hpp"
#include "core/recorder.hpp"
#include "core/run_control.hpp"
#include "core/simulation.hpp"
#include "core/threads.hpp"
#include "output/checkpoint.hpp"
#include "scene/reader.hpp"
#include "scene/settings.hpp"
#include "scene/units.hpp"

namespace embacle::mps {

namespace {

/// Windows between two questions whether the run shall end early.
constexpr int windows_per_epoch = 10;
/// With solids each epoch plans the coupling anew, and only then the water may be shared out anew.
constexpr int windows_per_coupled_epoch = 50;
/// Measured on a 2.4 GHz EPYC core: listed directed pairs per second, both sweeps; for the estimate of --check only.
constexpr double pairs_per_second = 2.0e8;
/// Measured: bytes of a particle while lists are built, beside the lists; of a process without particles
/// (docs/scaling.md).
constexpr double peak_bytes = 450, program_bytes = 4e7, program_with_solids_bytes = 6e7;

double seconds_of(const std::string& option, const std::string& text) {
  try {
    const Number number = evaluate(text, [](const std::string&) -> Number { throw ValueError("no parameters here"); });
    const double seconds = number.dimension ? to_si(number, Quantity::time, text) : number.value;
    if (seconds > 0) return seconds;
  } catch (const ValueError&) {  // the message below says it all
  }
  throw coupling::InputError(fmt::format(
      "{} needs a time greater than zero: seconds, or a number with unit such as 30min (units {}); not '{}'", option,
      usual_units(Quantity::time), text));
}

int threads_of(const std::string& given) {
  std::string name = "--threads", text = given;
  if (text.empty()) {
    const char* const variable = std::getenv("OMP_NUM_THREADS");
    if (variable == nullptr || *variable == '\0') return 1;
    name = "OMP_NUM_THREADS";
    text = variable;
    text = text.substr(0, text.find(','));  // the numbers that follow are for nested regions: there are none
  }
  int count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error == std::errc{} && end == text.data() + text.size() && count >= 1 && count <= most_threads) return count;
  throw coupling::InputError(
      fmt::format("{} needs a whole number of threads from 1 to {}, not '{}'", name, most_threads, text));
}

/// A restart without a scene takes that of the checkpoint, with its overrides, where the command line has no other.
void adopt_scene(Options& options) {
  const CheckpointReader checkpoint(options.restart);
  options.scene = checkpoint.text("scene");
  std::vector<std::string> overrides;
  std::istringstream lines(checkpoint.text("overrides"));
  const auto key_of = [](const std::string& text) { return text.substr(0, text.find('=')); };
  for (std::string line; std::getline(lines, line);) {
    if (std::none_of(options.overrides.begin(), options.overrides.end(),
                     [&](const std::string& own) { return key_of(own) == key_of(line); }))
      overrides.push_back(line);
  }
  options.overrides.insert(options.overrides.begin(), overrides.begin(), overrides.end());
}

void write_checkpoint(const Scene& scene, const Options& options, Simulation& simulation, const Recorder& recorder) {
  const Phases::Timer timer(simulation.phases(), Phase::output);
  simulation.confirm();
  CheckpointContent content;
  content.texts["settings"] = lasting_settings(scene);
  content.texts["scene"] = scene.file.string();
  content.texts["version"] = EMBACLE_VERSION;
  for (const std::string& text : options.overrides) content.texts["overrides"] += text + "\n";
  simulation.save(content);
  recorder.save(content);
  write_checkpoint(simulation.comm(), checkpoint_path(recorder.folder()), content);
}

coupling::FluidTerms terms_of(const Scene& scene, const Constants& c) {
  coupling::FluidTerms terms;
  terms.gravity = {c.gravity[0], c.gravity[1], c.gravity[2]};
  terms.dimension = c.dimension;
  terms.scheme = scene.coupling.scheme == Scheme::serial ? coupling::Scheme::serial : coupling::Scheme::parallel;
  terms.particle_distance = c.particle_distance;
  terms.point_depth = c.layers * c.particle_distance;
  terms.reach = c.support + c.skin;
  terms.reference_speed = c.reference_speed;
  terms.fluid_density = c.density;
  return terms;
}

}  // namespace

Options parse_options(int argc, char** argv, const std::string& program, const std::string& description) {
  Options options;
  CLI::App app{description, program};
  std::string end_time, wall_limit, threads;
  bool check = false, explain = false, launch = false, reference = false;
  app.set_version_flag("--version", program + " " EMBACLE_VERSION);
  app.add_option("scene", options.scene, "Scene: a .toml file, or a folder that holds scene.toml");
  const CLI::Option* const out = app.add_option("--out", options.out, "Output folder");
  app.add_option("--set", options.overrides, "Override: key.path=value (repeatable)")->allow_extra_args(false);
  app.add_option("--end-time", end_time, "Simulated time at which to stop (overrides run.end_time)");
  app.add_option("--restart", options.restart,
                 "Continue from a checkpoint or from the results folder that holds it; without --out in that folder, "
                 "without a scene with that of the checkpoint");
  app.add_option("--wall-limit", wall_limit, "Wall-clock time after which to write a checkpoint and end with status 5");
  app.add_option("--threads", threads,
                 "Threads of each rank for the water (default: OMP_NUM_THREADS, or 1 where that is not set)");
  app.add_flag("--check", check, "Read, validate, build the particles, print counts, memory, time step; run nothing");
  app.add_option("--ranks", options.planned_ranks, "With --check: the number of ranks to estimate for")
      ->check(CLI::Range(1, 1 << 20));
  app.add_flag("--explain", explain, "Which physics and modules the scene uses and leaves out");
  app.add_flag("--launch", launch, "Print what a launcher needs: the LIGGGHTS script and its variables");
  app.add_flag("--reference", reference, "Print the reference page of all scene keys (Markdown)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      app.exit(error);
      options.task = Options::Task::leave;
      return options;
    }
    throw coupling::InputError(fmt::format("{}; see '{} --help'", error.what(), program));
  }
  if (!end_time.empty()) options.overrides.push_back("run.end_time=" + end_time);
  if (!wall_limit.empty()) options.wall_limit = seconds_of("--wall-limit", wall_limit);
  options.threads = threads_of(threads);
  if (!options.restart.empty()) {
    if (out->count() == 0) options.out = CheckpointReader(options.restart).path().parent_path();
    if (options.out.empty()) options.out = ".";
    if (options.scene.empty()) adopt_scene(options);
  }
  options.task = check       ? Options::Task::check
                 : explain   ? Options::Task::explain
                 : launch    ? Options::Task::launch
                 : reference ? Options::Task::reference
                             : Options::Task::run;
  if (options.scene.empty() && !reference) {
    throw coupling::InputError(
        fmt::format("which scene? give a .toml file or a folder that holds scene.toml; see '{} --help'", program));
  }
  return options;
}

void check_restart(const Scene& scene, const Options& options) {
  if (options.restart.empty()) return;
  const CheckpointReader checkpoint(options.restart);
  compare_settings(scene, lasting_settings(scene), checkpoint.text("settings"), checkpoint.path().string());
}

std::string check_report(const Scene& scene, int ranks) {
  const Constants c = constants_of(scene);
  const Walls walls(scene, scene.dimension, c.layers);
  const InitialParticles initial = fill(scene, c, walls, 0, 1);
  const double steps = std::ceil(scene.end_time / c.step);
  const double reach = c.support + c.skin;
  const double listed = scene.dimension == 3 ? 4.19 * std::pow(reach / c.particle_distance, 3)
                                             : 3.14 * std::pow(reach / c.particle_distance, 2);
  const double n = static_cast<double>(initial.water.size());
  const double seconds = steps * n * 2 * listed / pairs_per_second / ranks;
  const double bytes = n * (listed * 3 + 140) + static_cast<double>(initial.walls.size()) * 120;
  const double at_peak = (n + static_cast<double>(initial.walls.size())) * (listed * 3.6 + peak_bytes) +
                         ranks * (scene.coupled() ? program_with_solids_bytes : program_bytes);
  std::string report = fmt::format(
      "{}: ok\n"
      "  water particles   {}\n  wall points       {}\n  solids            {}\n"
      "  particle distance {:g} m, support {:g} m ({} neighbours)\n"
      "  sound speed       {:.4g} m/s (reference speed {:.4g} m/s)\n"
      "  time step         {:.4g} s ({}), {:.0f} steps to {:g} s\n"
      "  memory            {:.0f} MB of particles and lists; of the processes about {:.0f} MB\n"
      "  estimated run     {:.0f} s on {} rank{}: {:.3g} core-hours for the water\n",
      scene.file.string(), initial.water.size(), initial.walls.size(),
      scene.coupled() ? "from " + scene.coupling.script.filename().string() : std::string("none"), c.particle_distance,
      c.support, c.lattice.neighbours, c.sound_speed, c.reference_speed, c.step, name_of(c.step_limit), steps,
      scene.end_time, bytes * 1e-6, at_peak * 1e-6, seconds, ranks, ranks == 1 ? "" : "s", seconds * ranks / 3600);
  for (const std::string& warning : initial.warnings) report += "  warning: " + warning + "\n";
  return report;
}

std::string explain_report(const Scene& scene) {
  const Constants c = constants_of(scene);
  std::string used, left;
  const auto module = [&](bool on, const std::string& name, const std::string& cost) {
    (on ? used : left) += fmt::format("  {:<34} {}\n", name, cost);
  };
  const Numerics& n = scene.numerics;
  const bool solids = !scene.walls.empty() || scene.coupled();
  bool moving = false, thin = false;
  const Walls walls(scene, scene.dimension, c.layers);
  for (int w = 0; w < walls.count(); ++w) thin = thin || walls.thin_index(w) >= 0;
  moving = walls.any_moves();
  module(true, fmt::format("weakly compressible MPS, {}-D", c.dimension),
         fmt::format("2 sweeps a step over {} neighbours ({} weight)", c.lattice.neighbours,
                     c.kernel == KernelKind::wendland ? "Wendland" : "rational"));
  module(n.integrator == Integrator::symplectic, "symplectic integrator", "all sweeps and messages twice");
  std::string directions;
  for (const std::string& axis : scene.periodic) directions += (directions.empty() ? " in " : ", ") + axis;
  module(!scene.periodic.empty(), "periodic directions" + directions, "ghosts of the images, also on one rank");
  module(n.diffusion_coefficient() > 0, "density diffusion", "in the density sweep");
  module(n.adaptive_step, "adaptive time step", "in the reduction of each step");
  module(n.artificial_viscosity > 0, "artificial viscosity", "in the force sweep");
  module(c.collision_distance > 0, "particle collision", "in the force sweep");
  module(scene.fluid.kinematic_viscosity > 0, "viscosity, no slip", "in the force sweep");
  module(c.smagorinsky > 0, "turbulence (Smagorinsky)", "two sweeps over pairs of water, a message a step");
  module(c.wall_friction, "walls that say whether water slips", "a pass over pairs of water and solids");
  module(c.central_force > 0, "central force",
         n.diffusion_coefficient() > 0 ? "a pass over the water and a sweep over its pairs" : "a pass over the water");
  module(solids,
         n.wall_pressure == WallPressure::continuity      ? "walls: pressure by continuity"
         : n.wall_pressure == WallPressure::zero_gradient ? "walls: mean pressure of the water"
                                                          : "walls: extrapolated pressure",
         "a sweep over wet wall points");
  module(moving, "moving walls", "a pass over wall points");
  module(thin, "thin walls seen from one side", "checks near them when lists are built");
  module(scene.coupled(), "bodies (LIGGGHTS)",
         fmt::format("points, loads, a message per partner rank and window of {} step{}",
                     scene.coupling.steps_per_window, scene.coupling.steps_per_window == 1 ? "" : "s"));
  module(scene.coupled() && scene.coupling.loads == Loads::pressure, "loads by surface pressure",
         "a pass over body points");
  module(scene.coupled() && scene.coupling.predictor && scene.coupling.steps_per_window > 1, "predictor of the bodies",
         "a message between ranks that share a body, each step");
  module(scene.output.fields, "fields (HDF5)", "at output times");
  module(std::ranges::any_of(scene.walls, &Wall::forces), "forces on structures", "a sum over wall points");
  module(!scene.openings.empty(), "open boundaries", "two reductions a list; their zones are particles as others");
  module(!scene.sponges.empty(), "sponges", "a pass over the water");
  module(!scene.gauges.empty(), "gauges", "a reduction each, at their times");
  module(scene.output.audit, "conservation audit", "a reduction a window");
  module(scene.output.checkpoint_every > 0 || scene.output.checkpoint_wall > 0, "checkpoints (HDF5)",
         "at their times: 112 bytes a particle and wall point, down to the disk");
  std::string report = "uses\n" + used;
  if (!left.empty()) report += "leaves out (no memory, no time, no messages)\n" + left;
  if (!scene.coupled()) report += "coupling messages: none; body arrays: none\n";
  return report;
}

std::string launch_report(const Scene& scene) {
  if (!scene.coupled()) return "script=\n";
  std::string report = "script=" + scene.coupling.script.string() + "\n";
  for (const auto& [name, value] : scene.coupling.variables) report += "var=" + name + " " + value + "\n";
  return report;
}

Outcome run_water(const Scene& scene, const Options& options, const coupling::Participants* participants, MPI_Comm own,
                  coupling::YieldHook yield) {
  const double program_began = MPI_Wtime();
  const bool restarted = !options.restart.empty();
  std::unique_ptr<CheckpointReader> restart;
  if (restarted) restart = std::make_unique<CheckpointReader>(options.restart);
  std::optional<coupling::FluidLink> link;
  if (participants != nullptr) {
    coupling::FluidTerms terms = terms_of(scene, constants_of(scene));
    if (restart) terms.windows_before = restart->count("windows");
    link.emplace(*participants, own, terms, std::move(yield),
                 restart ? solid_memory(*restart) : std::vector<std::byte>{});
  }
  set_threads(options.threads);
  RunControl control(scene.output, options.wall_limit, program_began);
  // Neighbour lists and travelling particles take and give back megabytes every few steps; handing those to the system
  // and faulting them in again took a third of the run.
  mallopt(M_MMAP_THRESHOLD, 1 << 25);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_TOP_PAD, 1 << 26);
  const double began = MPI_Wtime();
  Simulation simulation(scene, own, link ? &*link : nullptr, restart.get());
  Recorder recorder(scene, simulation, options.out, restart.get());
  restart.reset();
  int rank = 0;
  MPI_Comm_rank(own, &rank);
  if (rank == 0) {
    for (const std::string& warning : simulation.warnings()) fmt::print("warning: {}\n", warning);
    if (restarted) fmt::print("continues from t = {:g} s\n", simulation.time());
  }

  bool started = restarted;
  bool saved = false;  // the present state stands in a checkpoint
  Request agreed = Request::none;
  const bool wants_checkpoints = scene.output.checkpoint_every > 0 || scene.output.checkpoint_wall > 0;
  const auto moved = [&] { return simulation.counters().steps > simulation.earlier_steps(); };
  const auto save = [&] {
    write_checkpoint(scene, options, simulation, recorder);
    control.checkpoint_written();
    saved = true;
  };
  for (;;) {
    const double left = std::ceil((scene.end_time - simulation.time()) / simulation.window_length() - 1e-6);
    if (!ends_the_run(agreed)) agreed = control.agree(own);
    // Epochs begin at the same steps whether the run was restarted in between or not.
    // With solids a checkpoint is possible between epochs only: they end where one is due.
    const int length =
        link ? control.windows_to_checkpoint(simulation.time(), simulation.window_length(), windows_per_coupled_epoch)
             : windows_per_epoch;
    const int into = link ? 0 : static_cast<int>(simulation.counters().windows % windows_per_epoch);
    const int wanted = ends_the_run(agreed) ? 0 : static_cast<int>(std::clamp(left, 0.0, double(length - into)));
    if (wanted == 0 && moved() && !saved && (ends_the_run(agreed) || wants_checkpoints)) save();
    const int windows = into > 0 && wanted > 0 ? wanted : simulation.begin_epoch(wanted);
    if (windows == 0) break;
    if (!started) recorder.record(false);
    started = true;
    for (int w = 0; w < windows && (link || !ends_the_run(agreed)); ++w) {
      simulation.request(static_cast<int>(control.wish()));
      simulation.window();
      recorder.record(w + 1 == left);
      agreed = std::max(agreed, static_cast<Request>(simulation.agreed_request()));
      saved = false;
      if ((!link || w + 1 == windows) && !ends_the_run(agreed) &&
          control.checkpoint_due(simulation.time(), simulation.window_length(), agreed)) {
        save();
        agreed = Request::none;
      }
    }
  }
  if (ends_the_run(agreed) && started) recorder.measure_end();

  Outcome outcome;
  outcome.summary = recorder.summary(link ? &*link : nullptr, MPI_Wtime() - began);
  outcome.summary.set("ended_by", name_of(agreed));
  outcome.status = status_of(agreed);
  if (ends_the_run(agreed)) {
    outcome.farewell = fmt::format(
        "ended by {} at t = {:g} s of {:g} s; {}\n", name_of(agreed), simulation.time(), scene.end_time,
        moved() ? "continue with --restart " + recorder.folder().string() : "nothing was done since the start");
  } else if (restarted && !moved()) {
    outcome.farewell = fmt::format("the run was at its end already; --end-time makes it longer\n");
  }
  return outcome;
}

void end_run(const std::string& program, const std::exception& error) {
  const auto* known = dynamic_cast<const coupling::RunError*>(&error);
  const int status = static_cast<int>(known != nullptr ? known->status() : coupling::ExitStatus::internal);
  std::fflush(stdout);
  int initialised = 0;
  int rank = 0, size = 1;
  MPI_Initialized(&initialised);
  if (initialised != 0) {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
  }
  // An error of the input is found by every rank at once: the first speaks, and its abort ends the others.
  if (rank != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  fmt::print(stderr, "{}: {}{}\n", program, known != nullptr ? "" : "internal error: ", error.what());
  std::fflush(stderr);
  if (size > 1) MPI_Abort(MPI_COMM_WORLD, status);
  std::_Exit(status);
}

}  // namespace embacle::mps
