#pragma once

#include <string>

namespace sgraphs::spy {

// Becomes LCM's own lcm-spy (a Java program) with our types and plug-ins, on a class path that today's Java
// takes: the script that Debian packages asks for an option that was removed. Does not return; throws Error
// that says what to install if something is missing. url: empty: LCM's default.
[[noreturn]] void runGraphicSpy(const std::string& url);

}  // namespace sgraphs::spy
