#include "tools/bench/accuracy/result_store.h"

#include <cctype>
#include <filesystem>
#include <utility>

#include "common/base/error.h"
#include "common/base/sha256.h"
#include "common/io/text_file.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/scene_file.h"

namespace sgraphs::bench {

namespace fs = std::filesystem;

ResultStore::ResultStore(std::string folder, bool any_program)
    : folder_(std::move(folder)), any_program_(any_program) {
  createFolder(folder_);
}

std::string ResultStore::pathOf(const RunKey& key) const {
  std::string scene = key.scene;
  for (char& c : scene)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  std::string name = scene + "-" + std::to_string(key.seed) + "-" + key.run;
  if (!key.settings.empty()) {
    Sha256 digest;
    digest.add(key.settings);
    name += "-" + digest.hex().substr(0, 8);
  }
  return folder_ + "/" + name + ".json";
}

std::optional<RunResult> ResultStore::find(const RunKey& key) const {
  const std::string path = pathOf(key);
  if (!fs::exists(path)) return std::nullopt;
  RunResult result = resultFromJson(readFile(path), path);
  RunKey expected = key;
  if (any_program_) expected.program = result.key.program;
  if (!(result.key == expected) || !result.failed.empty()) return std::nullopt;
  return result;
}

void ResultStore::save(const RunResult& result) const {
  const std::string path = pathOf(result.key);
  writeFile(path + ".new", toJson(result));
  std::error_code failed;
  fs::rename(path + ".new", path, failed);
  if (failed) throw Error("cannot write '" + path + "': " + failed.message());
}

std::string sceneDigest(const std::string& scene) {
  const fs::path plan = simulate::findScene(scene);
  Sha256 digest;
  digest.add(sha256OfFile(plan.string()));
  for (const simulate::MeshFile& mesh : simulate::loadScene(plan.string()).meshes) {
    const fs::path beside = plan.parent_path() / mesh.path;  // an absolute path stays what it is
    digest.add(sha256OfFile(fs::exists(beside) ? beside.string() : mesh.path));
  }
  return digest.hex();
}

}  // namespace sgraphs::bench
