#include "common/io/ply.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>

#include "common/base/error.h"
#include "common/io/text_file.h"

namespace sgraphs {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary PLY is read and written as it lies in memory");

struct Property {
  std::string name;
  std::string type;        // of the value, or of a list's entries
  std::string count_type;  // empty: no list
};

struct Element {
  std::string name;
  size_t count = 0;
  std::vector<Property> properties;
};

struct Contents {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<uint8_t> floors;
  std::vector<Eigen::Vector3i> triangles;
};

template <typename T>
double load(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return static_cast<double>(value);
}

struct ScalarType {
  size_t size;
  double (*load)(const char*);
};

const std::map<std::string, ScalarType>& scalarTypes() {
  static const std::map<std::string, ScalarType> types = {
      {"char", {1, load<int8_t>}},     {"int8", {1, load<int8_t>}},     {"uchar", {1, load<uint8_t>}},
      {"uint8", {1, load<uint8_t>}},   {"short", {2, load<int16_t>}},   {"int16", {2, load<int16_t>}},
      {"ushort", {2, load<uint16_t>}}, {"uint16", {2, load<uint16_t>}}, {"int", {4, load<int32_t>}},
      {"int32", {4, load<int32_t>}},   {"uint", {4, load<uint32_t>}},   {"uint32", {4, load<uint32_t>}},
      {"float", {4, load<float>}},     {"float32", {4, load<float>}},   {"double", {8, load<double>}},
      {"float64", {8, load<double>}}};
  return types;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), bytes_(readFile(path)) {}

  Contents read() {
    readHeader();
    Contents contents;
    for (const Element& element : elements_) {
      // A corrupt count must not allocate: every entry takes at least one byte.
      if (element.count > bytes_.size() - at_) fail("its header promises more than the file holds");
      for (size_t i = 0; i < element.count; ++i) readEntry(element, contents);
    }
    for (const auto& t : contents.triangles)
      if (t.minCoeff() < 0 || t.maxCoeff() >= static_cast<int>(contents.vertices.size()))
        fail("a face names a vertex that does not exist");
    return contents;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error("cannot read PLY '" + path_ + "': " + what);
  }

  std::string headerLine() {
    const size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) fail("no 'end_header' line");
    std::string line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  }

  void readHeader() {
    if (bytes_.rfind("ply", 0) != 0) fail("it does not begin with 'ply'");
    headerLine();
    for (std::string line = headerLine(); line != "end_header"; line = headerLine()) {
      std::istringstream row(line);
      std::string word;
      row >> word;
      if (word == "format") {
        row >> word;
        if (word != "ascii" && word != "binary_little_endian")
          fail("format '" + word + "' is not supported: use ascii or binary_little_endian");
        ascii_ = word == "ascii";
      } else if (word == "element") {
        Element element;
        row >> element.name >> element.count;
        if (!row) fail("bad header line '" + line + "'");
        elements_.push_back(element);
      } else if (word == "property") {
        readProperty(row, line);
      }
    }
  }

  void readProperty(std::istringstream& row, const std::string& line) {
    Property property;
    row >> property.type;
    if (property.type == "list") row >> property.count_type >> property.type;
    row >> property.name;
    const auto known = [](const std::string& type) { return type.empty() || scalarTypes().count(type); };
    if (!row || elements_.empty() || !known(property.type) || !known(property.count_type))
      fail("bad header line '" + line + "'");
    elements_.back().properties.push_back(property);
  }

  double value(const std::string& type) {
    if (!ascii_) {
      const ScalarType& scalar = scalarTypes().at(type);
      if (bytes_.size() - at_ < scalar.size) fail("it is cut short");
      at_ += scalar.size;
      return scalar.load(bytes_.data() + at_ - scalar.size);
    }
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_]))) ++at_;
    double number = 0;
    const char* const end = bytes_.data() + bytes_.size();
    const auto [stop, error] = std::from_chars(bytes_.data() + at_, end, number);
    if (error != std::errc()) fail(at_ >= bytes_.size() ? "it is cut short" : "a value is no number");
    at_ = static_cast<size_t>(stop - bytes_.data());
    return number;
  }

  void readEntry(const Element& element, Contents& contents) {
    const bool is_vertex = element.name == "vertex";
    Eigen::Vector3d position = Eigen::Vector3d::Constant(NAN);
    for (const Property& property : element.properties) {
      if (!property.count_type.empty()) {
        readList(element, property, contents);
        continue;
      }
      const double v = value(property.type);
      if (!is_vertex) continue;
      if (property.name == "x") position.x() = v;
      if (property.name == "y") position.y() = v;
      if (property.name == "z") position.z() = v;
      if (property.name == "floor") contents.floors.push_back(static_cast<uint8_t>(v));
    }
    if (!is_vertex) return;
    if (!position.allFinite()) fail("a vertex has no finite x, y and z");
    contents.vertices.push_back(position);
  }

  void readList(const Element& element, const Property& property, Contents& contents) {
    const double count = value(property.count_type);
    if (!(count >= 0) || count > static_cast<double>(bytes_.size())) fail("a list has a bad length");
    std::vector<int> entries;
    for (int i = 0; i < static_cast<int>(count); ++i) {
      const double v = value(property.type);
      if (!(std::abs(v) < 2e9)) fail("a face names a vertex that does not exist");
      entries.push_back(static_cast<int>(v));
    }
    const bool is_face = element.name == "face" && property.name.rfind("vertex_ind", 0) == 0;
    for (size_t i = 2; is_face && i < entries.size(); ++i)
      contents.triangles.emplace_back(entries[0], entries[i - 1], entries[i]);
  }

  std::string path_;
  std::string bytes_;
  size_t at_ = 0;
  bool ascii_ = true;
  std::vector<Element> elements_;
};

}  // namespace

TriangleMesh readPlyMesh(const std::string& path) {
  Contents contents = Reader(path).read();
  if (contents.triangles.empty()) throw Error("mesh '" + path + "' holds no face: it needs triangles");
  return {std::move(contents.vertices), std::move(contents.triangles)};
}

PointCloud readPlyPoints(const std::string& path) {
  const Contents contents = Reader(path).read();
  PointCloud cloud;
  cloud.points.reserve(contents.vertices.size());
  for (const auto& v : contents.vertices) cloud.points.push_back(v.cast<float>());
  cloud.floors = contents.floors;
  return cloud;
}

void writePlyPoints(const std::string& path, const PointCloud& cloud) {
  const bool has_floors = !cloud.floors.empty();
  if (has_floors && cloud.floors.size() != cloud.points.size())
    throw std::logic_error("writePlyPoints: floors and points differ in number");
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(cloud.points.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n" +
                      (has_floors ? "property uchar floor\n" : "") + "end_header\n";
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    bytes.append(reinterpret_cast<const char*>(cloud.points[i].data()), 3 * sizeof(float));
    if (has_floors) bytes.push_back(static_cast<char>(cloud.floors[i]));
  }
  writeFile(path, bytes);
}

void writePlyMesh(const std::string& path, const TriangleMesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                     std::to_string(mesh.triangles.size()) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  char line[128];
  for (const auto& v : mesh.vertices) {
    std::snprintf(line, sizeof line, "%.6f %.6f %.6f\n", v.x(), v.y(), v.z());
    text += line;
  }
  for (const auto& t : mesh.triangles) {
    std::snprintf(line, sizeof line, "3 %d %d %d\n", t.x(), t.y(), t.z());
    text += line;
  }
  writeFile(path, text);
}

}  // namespace sgraphs
