#include "tools/run/text_screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace sgraphs {
namespace {

constexpr int kEvery = 5;

// A line that wraps would spoil the count of lines to go up.
size_t columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - size_t{1} : 79;
}

}  // namespace

TextScreen::TextScreen() : terminal_(isatty(STDERR_FILENO) != 0) {}

void TextScreen::erase() {
  if (shown_ > 0) std::fprintf(stderr, "\033[%zuA\033[J", shown_);
  shown_ = 0;
}

void TextScreen::show(const std::vector<std::string>& lines) {
  if (!terminal_) {
    if (calls_++ % kEvery == 0 && !lines.empty()) std::fprintf(stderr, "%s\n", lines.front().c_str());
    return;
  }
  erase();
  for (const std::string& line : lines) std::fprintf(stderr, "%s\n", line.substr(0, columns()).c_str());
  shown_ = lines.size();
  std::fflush(stderr);
}

void TextScreen::say(const std::string& line) {
  erase();
  std::fprintf(stderr, "sgraphs: %s\n", line.c_str());
}

void TextScreen::leave() {
  shown_ = 0;
}

}  // namespace sgraphs
