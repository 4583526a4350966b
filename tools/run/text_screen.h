#pragma once

#include <string>
#include <vector>

namespace sgraphs {

// Text on stderr: on a terminal one screen that is renewed in place, elsewhere a line now and then.
class TextScreen {
 public:
  TextScreen();

  // At 1 Hz. `lines`: the screen, the first of which stands for it elsewhere, every 5th time.
  void show(const std::vector<std::string>& lines);
  // A line that stays.
  void say(const std::string& line);
  // What comes next is written below.
  void leave();

 private:
  void erase();

  bool terminal_;
  size_t shown_ = 0;  // lines on the screen
  int calls_ = 0;
};

}  // namespace sgraphs
