#include "tools/simulate/building/mesh_assimp.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>

#include "common/base/error.h"
#include "tools/simulate/building/mesh_surface.h"

namespace sgraphs::simulate {
namespace {

void addMesh(TriangleMesh& out, const aiMesh& mesh, const aiMatrix4x4& T_file_node) {
  const auto first = static_cast<uint32_t>(out.vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D v = T_file_node * mesh.mVertices[i];
    out.vertices.emplace_back(v.x, v.y, v.z);
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;  // a point or a line
    addTriangle(out, {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]},
                kMeshReflectivity);
  }
}

void addNode(TriangleMesh& out, const aiScene& scene, const aiNode& node, const aiMatrix4x4& T_file_parent) {
  const aiMatrix4x4 T_file_node = T_file_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) addMesh(out, *scene.mMeshes[node.mMeshes[i]], T_file_node);
  for (unsigned i = 0; i < node.mNumChildren; ++i) addNode(out, scene, *node.mChildren[i], T_file_node);
}

// The library's reason in one line.
std::string reasonOf(const Assimp::Importer& importer) {
  std::string reason = importer.GetErrorString();
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return reason;
}

}  // namespace

TriangleMesh readMeshFile(const std::string& path) {
  if (!std::filesystem::is_regular_file(path))
    throw Error("mesh '" + path + "' is not there: check the path");
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode)
    throw Error("mesh '" + path + "' cannot be read: " + reasonOf(importer) + "; export it anew");
  TriangleMesh mesh;
  addNode(mesh, *scene, *scene->mRootNode, {});
  // The library turns what a DAE file holds so that y points up.
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending == ".dae")
    for (Eigen::Vector3d& v : mesh.vertices) v = Eigen::Vector3d(v.x(), -v.z(), v.y());
  return mesh;
}

}  // namespace sgraphs::simulate
