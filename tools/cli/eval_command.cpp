#include <cstdio>
#include <memory>

#include "common/io/text_file.h"
#include "tools/cli/commands.h"
#include "tools/eval/eval_plots.h"
#include "tools/eval/eval_report.h"
#include "tools/eval/evaluate.h"

namespace sgraphs::cli {
namespace {

struct EvalArguments {
  std::string out_dir;
  std::string truth_dir;
};

void runEvalCommand(const EvalArguments& options) {
  const Truth truth = readTruth(options.truth_dir);
  const Evaluation evaluation = evaluate(options.out_dir, truth);
  std::fputs(evaluationTable(evaluation).c_str(), stdout);
  writeFile(options.out_dir + "/eval.json", evaluationJson(evaluation));
  std::string written = "eval.json";
  for (const auto& [name, png] : evaluationPlots(evaluation, truth)) {
    writeFile(options.out_dir + "/" + name, png);
    written += ", " + name;
  }
  std::printf("wrote %s/%s\n", options.out_dir.c_str(), written.c_str());
}

}  // namespace

void addEval(CLI::App& app) {
  auto options = std::make_shared<EvalArguments>();
  CLI::App* command =
      app.add_subcommand("eval", "Judge a run's OUT against the truth: table, eval.json, plots");
  command->add_option("OUT", options->out_dir, "folder that 'sgraphs replay' wrote")->required();
  command
      ->add_option("--truth", options->truth_dir,
                   "folder with gt.tum (body in the building's frame), and optionally mesh.ply and plan.json")
      ->required();
  command->footer(
      "Example:\n  sgraphs eval out --truth truth\n\n"
      "ATE: translation after SE(3) alignment without scale, truth interpolated at the estimate's stamps;\n"
      "evo: the same with evo_ape's nearest stamps. The alignment of trajectory.tum moves the map.\n"
      "Completeness: mesh area within 10 m and line of sight of the path that has a map point within 5 cm.\n"
      "NEES: 3 if the links' covariances are what they claim to be; of optimised poses and planes, relative "
      "to\nthe first keyframe: the number in brackets.\n"
      "Walls: the two sides of each wall of plan.json; asked for are those that the sensor had in view for 5 "
      "s\n"
      "(docs/accuracy.md).\n"
      "Rooms: IoU of 0.5 or more with the true polygon, one to one, on each floor; asked for are those that "
      "the "
      "path\nis inside of for 1 s. Floors: within 0.3 m. Doorways: within 0.5 m.");
  command->callback([options] { runEvalCommand(*options); });
}

}  // namespace sgraphs::cli
