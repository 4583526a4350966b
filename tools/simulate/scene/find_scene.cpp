#include "tools/simulate/scene/find_scene.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "common/base/error.h"

namespace sgraphs::simulate {
namespace {

namespace fs = std::filesystem;

// Folders of shipped scenes that exist, in the order in which they are searched.
std::vector<fs::path> sceneFolders() {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("SGRAPHS_SCENES")) {
    folders.emplace_back(chosen);
  } else {
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    folders.push_back(program.parent_path() / ".." / "share" / "sgraphs" / "scenes");
    folders.emplace_back(SGRAPHS_SOURCE_SCENES_DIR);
  }
  std::erase_if(folders, [](const fs::path& folder) { return !fs::is_directory(folder); });
  return folders;
}

std::string knownScenes() {
  std::vector<std::string> names;
  for (const fs::path& folder : sceneFolders())
    for (const auto& entry : fs::directory_iterator(folder))
      if (fs::exists(entry.path() / "plan.json")) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none is installed (see $SGRAPHS_SCENES)" : text;
}

}  // namespace

bool isMeshPath(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending == ".ply" || ending == ".obj" || ending == ".stl" || ending == ".dae" || ending == ".sdf";
}

std::string findScene(const std::string& scene) {
  const fs::path path(scene);
  if (fs::is_regular_file(path)) return scene;
  if (isMeshPath(scene)) throw UsageError("mesh '" + scene + "' is not there: check the path");
  if (fs::is_regular_file(path / "plan.json")) return (path / "plan.json").string();
  if (scene.find('/') == std::string::npos)
    for (const fs::path& folder : sceneFolders())
      if (fs::is_regular_file(folder / scene / "plan.json"))
        return (folder / scene / "plan.json").lexically_normal().string();
  throw UsageError("scene '" + scene +
                   "' is neither a plan.json, nor a mesh, nor a shipped scene: give a file, or one of " +
                   knownScenes());
}

}  // namespace sgraphs::simulate
