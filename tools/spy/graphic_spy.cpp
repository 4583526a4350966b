#include "tools/spy/graphic_spy.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <vector>

#include "common/base/error.h"
#include "common/base/exec_arguments.h"

namespace sgraphs::spy {
namespace {

namespace fs = std::filesystem;

constexpr char kOrText[] = "; `sgraphs spy --text` works without";

bool onPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

// The same place beside the programs in a build tree and in an installed one.
fs::path typeJar() {
  return fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "share" / "java" /
         "sgraphs_spy.jar";
}

// Class path of lcm-spy; throws Error naming the packages that are missing. jchart2d.jar names the last two
// itself; named here, lcm-spy would search them for plug-ins and complain of what it finds.
std::string classPath() {
  const struct {
    const char *file, *package;
    bool named;
  } needed[] = {{"lcm.jar", "liblcm-java", true},
                {"jchart2d.jar", "libjchart2d-java", true},
                {"jide-oss.jar", "libjide-oss-java", false},
                {"xmlgraphics-commons.jar", "libxmlgraphics-commons-java", false}};
  std::string path, missing;
  for (const auto& [file, package, named] : needed) {
    const fs::path jar = fs::path("/usr/share/java") / file;
    if (!fs::exists(jar)) missing += std::string(" ") + package;
    if (named) path += jar.string() + ":";
  }
  if (!onPath("java")) missing += " default-jre";
  if (!missing.empty()) throw Error("lcm-spy lacks packages: apt-get install" + missing + kOrText);
  return path;
}

}  // namespace

void runGraphicSpy(const std::string& url) {
  const std::string class_path = classPath();
  const fs::path jar = typeJar();
  if (!fs::exists(jar))
    throw Error("the jar of the message types was not built, for want of a Java compiler: apt-get install " +
                std::string("default-jdk-headless liblcm-java, configure and build again") + kOrText);
  if (!std::getenv("DISPLAY"))
    throw Error(std::string("lcm-spy draws on a screen, and DISPLAY is not set") + kOrText);
  // Plug-ins listen on the default URL.
  if (!url.empty()) setenv("LCM_DEFAULT_URL", url.c_str(), 1);
  // 128 MB, which Debian's script allows, are too few for large arrays.
  const std::vector<std::string> words{"java", "-Djava.net.preferIPv4Stack=true", "-Xmx512m",
                                       "-cp",  class_path + jar.string(),         "lcm.spy.Spy"};
  const std::vector<char*> arguments = execArguments(words);
  execvp(arguments[0], arguments.data());
  throw Error(std::string("cannot start java: ") + std::strerror(errno));
}

}  // namespace sgraphs::spy
