#pragma once

#include <string>

namespace sgraphs {

// Whole files, byte for byte. Both throw Error naming the path.
std::string readFile(const std::string& path);
void writeFile(const std::string& path, const std::string& bytes);

// Creates the folder and its parents. Throws Error naming it.
void createFolder(const std::string& path);

}  // namespace sgraphs
