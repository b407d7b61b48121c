#include "tests/cli/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace dmvv::tests {
namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + '\'';
}

}  // namespace

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

Run run_dmvv(const std::vector<std::string>& arguments, std::string_view input) {
  const Folder folder;
  std::string command = quoted(DMVV_PROGRAM);
  for (const std::string& argument : arguments) command += ' ' + quoted(argument);
  command += " <" + quoted(folder.write("in", input));
  command += " >" + quoted(folder.file("out")) + " 2>" + quoted(folder.file("err"));
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, folder.read("out"), folder.read("err")};
}

pid_t start_dmvv(const std::vector<std::string>& arguments, const std::string& err_path) {
  std::vector<std::string> words{DMVV_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err_path.c_str(), O_WRONLY | O_CREAT | O_NOCTTY, 0600);
  pid_t process = -1;
  const int error = posix_spawn(&process, pointers[0], &files, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw std::runtime_error("cannot start " + words[0]);
  return process;
}

Folder::Folder() {
  std::string path = (fs::temp_directory_path() / "dmvv-test-XXXXXX").string();
  if (!mkdtemp(path.data())) throw std::runtime_error("cannot make a folder like " + path);
  path_ = path;
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string Folder::write(std::string_view name, std::string_view bytes) const {
  std::ofstream(file(name), std::ios::binary) << bytes;
  return file(name);
}

std::string Folder::read(std::string_view name) const { return read_file(file(name)); }

std::vector<std::string> Folder::listing() const {
  std::vector<std::string> result;
  for (const auto& entry : fs::recursive_directory_iterator(path_)) result.push_back(entry.path().string());
  std::ranges::sort(result);
  return result;
}

}  // namespace dmvv::tests
