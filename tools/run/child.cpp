#include "tools/run/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/base/error.h"
#include "common/base/exec_arguments.h"

namespace sgraphs {
namespace {

// Between fork and exec: calls that are safe there, and nothing else.
[[noreturn]] void becomeProgram(char* const* arguments, int output, int failure, pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (getppid() == parent) {  // else it has died already
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    execvp(arguments[0], arguments);
  }
  const int error = errno;
  if (write(failure, &error, sizeof error) < 0) _exit(126);
  _exit(127);
}

}  // namespace

Child::Child(const std::vector<std::string>& command, const std::string& output_file) {
  const int output = open(output_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (output < 0) throw Error("cannot write '" + output_file + "': " + std::strerror(errno));
  const std::vector<char*> arguments = execArguments(command);
  int failure[2] = {-1, -1};  // closed by a successful exec
  if (pipe2(failure, O_CLOEXEC) != 0) throw Error(std::string("cannot make a pipe: ") + std::strerror(errno));
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) becomeProgram(arguments.data(), output, failure[1], parent);
  close(output);
  close(failure[1]);
  int error = pid_ < 0 ? errno : 0;
  if (pid_ >= 0 && read(failure[0], &error, sizeof error) == static_cast<ssize_t>(sizeof error)) {
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  close(failure[0]);
  if (pid_ < 0)
    throw Error("cannot start '" + command.front() + "': " + std::strerror(error) +
                "; is it built and on the PATH?");
}

Child::~Child() {
  if (exitCode()) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

std::optional<int> Child::exitCode() {
  int status = 0;
  if (!exit_code_ && waitpid(pid_, &status, WNOHANG) == pid_)
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return exit_code_;
}

void Child::signal(int number) {
  if (!exitCode()) kill(pid_, number);
}

std::string lastLineOf(const std::string& output_file) {
  std::ifstream in(output_file);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  return last;
}

}  // namespace sgraphs
