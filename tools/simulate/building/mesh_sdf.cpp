#include "tools/simulate/building/mesh_sdf.h"

#include <tinyxml2.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>

#include "common/base/error.h"
#include "common/geometry/degree.h"
#include "tools/simulate/building/mesh_assimp.h"
#include "tools/simulate/building/mesh_surface.h"

namespace sgraphs::simulate {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr double kLargestPlane_m = 200;  // of the ground planes of worlds, which have no end

std::string nameOf(const XMLElement& element) {
  const char* name = element.Attribute("name");
  return std::string(element.Name()) + (name ? " '" + std::string(name) + "'" : "");
}

class SdfReader {
 public:
  explicit SdfReader(std::string path) : path_(std::move(path)), folder_(fs::path(path_).parent_path()) {}

  SdfSurfaces read();

 private:
  [[noreturn]] void fail(const XMLElement& element, const std::string& what) const {
    throw Error(path_ + ":" + std::to_string(element.GetLineNum()) + ": " + what);
  }
  std::vector<double> numbers(const XMLElement& element, size_t count) const;
  std::vector<double> numbersOf(const XMLElement& parent, const char* child, size_t count) const;
  SE3 poseOf(const XMLElement& element) const;
  void readModels(const XMLElement& parent, const SE3& T_sdf_parent);
  void readLink(const XMLElement& link, const SE3& T_sdf_model);
  // What the link's shapes of one kind ("visual", "collision") look like; complete: no mesh is missing.
  TriangleMesh shapesOf(const XMLElement& link, const char* kind, bool& complete);
  // Nothing: a mesh that is not there, or a shape that is not known; noted.
  std::optional<TriangleMesh> shapeOf(const XMLElement& geometry);
  std::optional<TriangleMesh> meshOf(const XMLElement& mesh);
  TriangleMesh planeOf(const XMLElement& plane) const;
  std::optional<fs::path> find(const std::string& uri) const;
  std::vector<std::string> warnings() const;

  std::string path_;
  fs::path folder_;
  TriangleMesh mesh_;
  std::map<std::string, int> missing_;  // URIs of meshes
  std::map<std::string, int> unknown_;  // kinds of shapes
  int includes_ = 0;
};

std::vector<double> SdfReader::numbers(const XMLElement& element, size_t count) const {
  std::istringstream in(element.GetText() ? element.GetText() : "");
  std::vector<double> values;
  for (double value = 0; in >> value;) values.push_back(value);
  if (!in.eof() || values.size() != count)
    fail(element, "<" + std::string(element.Name()) + "> must hold " + std::to_string(count) + " numbers");
  return values;
}

std::vector<double> SdfReader::numbersOf(const XMLElement& parent, const char* child, size_t count) const {
  const XMLElement* element = parent.FirstChildElement(child);
  if (!element) fail(parent, "<" + std::string(parent.Name()) + "> lacks <" + child + ">");
  return numbers(*element, count);
}

SE3 SdfReader::poseOf(const XMLElement& element) const {
  const XMLElement* pose = element.FirstChildElement("pose");
  if (!pose || !pose->GetText()) return {};
  for (const char* attribute : {"relative_to", "frame"})
    if (const char* frame = pose->Attribute(attribute); frame && *frame)
      fail(*pose, "the pose of " + nameOf(element) + " is relative to '" + frame +
                      "', which is not followed: write it relative to its parent");
  if (const char* format = pose->Attribute("rotation_format"); format && std::string(format) != "euler_rpy") {
    const auto v = numbers(*pose, 7);
    return {Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized(), {v[0], v[1], v[2]}};
  }
  const auto v = numbers(*pose, 6);
  const double unit = pose->BoolAttribute("degrees", false) ? kDegree_rad : 1.0;
  // Roll, pitch and yaw about fixed axes.
  return {Eigen::AngleAxisd(unit * v[5], Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(unit * v[4], Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(unit * v[3], Eigen::Vector3d::UnitX()),
          {v[0], v[1], v[2]}};
}

std::optional<fs::path> SdfReader::find(const std::string& uri) const {
  fs::path wanted(uri);
  // model://house/meshes/a.dae stands beside house/model.sdf as meshes/a.dae.
  std::vector<fs::path> places;
  if (const size_t scheme = uri.find("://"); scheme != std::string::npos) {
    wanted = uri.substr(scheme + 3);
    if (uri.rfind("file://", 0) != 0) {
      fs::path below;
      for (auto part = std::next(wanted.begin(), wanted.empty() ? 0 : 1); part != wanted.end(); ++part)
        below /= *part;
      places.push_back(folder_ / below);
      places.push_back(folder_ / ".." / wanted);
    }
  }
  places.push_back(folder_ / wanted);
  for (const fs::path& place : places)
    if (fs::is_regular_file(place)) return place;
  return std::nullopt;
}

std::optional<TriangleMesh> SdfReader::meshOf(const XMLElement& mesh) {
  const XMLElement* uri = mesh.FirstChildElement("uri");
  if (!uri || !uri->GetText()) fail(mesh, "<mesh> lacks <uri>");
  const auto file = find(uri->GetText());
  if (!file) {
    ++missing_[uri->GetText()];
    return std::nullopt;
  }
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  if (mesh.FirstChildElement("scale")) scale = Eigen::Vector3d(numbersOf(mesh, "scale", 3).data());
  TriangleMesh out;
  append(out, readMeshFile(file->string()), {}, scale);
  return out;
}

TriangleMesh SdfReader::planeOf(const XMLElement& plane) const {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  if (plane.FirstChildElement("normal")) normal = Eigen::Vector3d(numbersOf(plane, "normal", 3).data());
  double x = kLargestPlane_m, y = kLargestPlane_m;
  if (plane.FirstChildElement("size")) {
    const auto size = numbersOf(plane, "size", 2);
    x = std::min(x, size[0]);
    y = std::min(y, size[1]);
  }
  TriangleMesh flat, out;
  flat.addQuad(
      {Eigen::Vector3d(-x / 2, -y / 2, 0), {x / 2, -y / 2, 0}, {x / 2, y / 2, 0}, {-x / 2, y / 2, 0}},
      kMeshReflectivity);
  append(out, flat,
         {Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal), Eigen::Vector3d::Zero()});
  return out;
}

std::optional<TriangleMesh> SdfReader::shapeOf(const XMLElement& geometry) {
  const XMLElement* shape = geometry.FirstChildElement();
  if (!shape) {
    ++unknown_["empty"];
    return std::nullopt;
  }
  const std::string kind = shape->Name();
  if (kind == "mesh") return meshOf(*shape);
  if (kind == "plane") return planeOf(*shape);
  if (kind == "box") {
    TriangleMesh box;
    box.addBox(Eigen::Vector3d::Zero(), Eigen::Vector3d(numbersOf(*shape, "size", 3).data()), 0,
               kMeshReflectivity);
    return box;
  }
  if (kind == "cylinder")
    return makeCylinder(numbersOf(*shape, "radius", 1)[0], numbersOf(*shape, "length", 1)[0]);
  ++unknown_[kind];
  return std::nullopt;
}

TriangleMesh SdfReader::shapesOf(const XMLElement& link, const char* kind, bool& complete) {
  TriangleMesh out;
  complete = true;
  for (const XMLElement* e = link.FirstChildElement(kind); e; e = e->NextSiblingElement(kind)) {
    const XMLElement* geometry = e->FirstChildElement("geometry");
    if (!geometry) fail(*e, nameOf(*e) + " lacks <geometry>");
    if (const auto shape = shapeOf(*geometry))
      append(out, *shape, poseOf(*e));
    else
      complete = false;
  }
  return out;
}

void SdfReader::readLink(const XMLElement& link, const SE3& T_sdf_model) {
  bool seen_whole = true, touched_whole = true;
  TriangleMesh shapes = shapesOf(link, "visual", seen_whole);
  if (!seen_whole || shapes.triangles.empty()) {
    const TriangleMesh touched = shapesOf(link, "collision", touched_whole);
    if (touched.triangles.size() > 0 && (touched_whole || shapes.triangles.empty())) shapes = touched;
  }
  append(mesh_, shapes, T_sdf_model * poseOf(link));
}

void SdfReader::readModels(const XMLElement& parent, const SE3& T_sdf_parent) {
  for (const XMLElement* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const std::string kind = e->Name();
    if (kind == "model") readModels(*e, T_sdf_parent * poseOf(*e));
    if (kind == "world") readModels(*e, T_sdf_parent);
    if (kind == "link") readLink(*e, T_sdf_parent);
    includes_ += kind == "include";
  }
}

std::vector<std::string> SdfReader::warnings() const {
  std::vector<std::string> lines;
  if (!missing_.empty())
    lines.push_back(path_ + ": " + std::to_string(missing_.size()) + " meshes are not beside it, the first " +
                    missing_.begin()->first + ": their collision shapes stand in, or nothing");
  for (const auto& [kind, count] : unknown_)
    lines.push_back(path_ + ": " + std::to_string(count) + " shapes <" + kind +
                    "> are left out: known are box, cylinder, plane and mesh");
  if (includes_ > 0)
    lines.push_back(path_ + ": " + std::to_string(includes_) +
                    " <include> are not followed: list their models among the plan's meshes");
  return lines;
}

SdfSurfaces SdfReader::read() {
  if (!fs::is_regular_file(path_)) throw Error("mesh '" + path_ + "' is not there: check the path");
  tinyxml2::XMLDocument document;
  if (document.LoadFile(path_.c_str()) != tinyxml2::XML_SUCCESS)
    throw Error(path_ + ":" + std::to_string(document.ErrorLineNum()) + ": this is not XML (" +
                document.ErrorName() + "): mend or export it anew");
  const XMLElement* root = document.FirstChildElement("sdf");
  if (!root) throw Error(path_ + ": has no <sdf> element: give an SDF file (sdformat.org)");
  readModels(*root, {});
  return {std::move(mesh_), warnings()};
}

}  // namespace

SdfSurfaces readSdf(const std::string& path) {
  return SdfReader(path).read();
}

}  // namespace sgraphs::simulate
