#include "common/base/error.h"
#include "tools/cli/commands.h"

namespace sgraphs::cli {

// Names that contract.md promises for later versions: whatever stands behind them, the answer is the same.
void addReserved(CLI::App& app) {
  for (const char* name : {"demo", "view"}) {
    CLI::App* command = app.add_subcommand(name, "Not in this version");
    command->footer(std::string("Example:\n  sgraphs ") + name);
    command->allow_extras();
    command->callback([name] { throw UsageError(std::string(name) + ": not in this version"); });
  }
}

}  // namespace sgraphs::cli
