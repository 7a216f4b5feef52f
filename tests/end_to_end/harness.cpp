#include "tests/end_to_end/harness.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include "frame/io/sequence.h"

namespace becalm::test {
namespace {

std::string read_text(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr mode_t kMode = 0600;  ///< of the files that take a process's streams

/// Integer hash (Wellons, lowbias32) to [0,1).
float random_unit(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  x ^= x >> 16;
  return static_cast<float>(x >> 8) * 0x1p-24f;
}

}  // namespace

TempFolder::TempFolder() {
  std::string name = (fs::temp_directory_path() / "becalm_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder like " + name);
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

Process::Process(const std::vector<std::string>& arguments, const std::string& shell_script)
    : command_("becalm") {
  std::vector<std::string> words{BECALM_EXECUTABLE};
  if (!shell_script.empty()) words.insert(words.begin(), {"bash", "-c", shell_script});
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  for (const std::string& argument : arguments) command_ += " '" + argument + "'";
  if (!shell_script.empty()) command_ = fmt::format("{} as \"$0\" \"$@\" of: {}", command_, shell_script);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, (streams_ / "out").c_str(), O_WRONLY | O_CREAT,
                                   kMode);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, (streams_ / "err").c_str(), O_WRONLY | O_CREAT,
                                   kMode);
  const int failure = posix_spawnp(&process_, pointers.front(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::runtime_error(fmt::format("cannot start {}", BECALM_EXECUTABLE));
}

Process::~Process() {
  if (process_ <= 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void Process::signal(int number) const {
  kill(process_, number);
}

std::string Process::err() const {
  return read_text(streams_ / "err");
}

bool Process::wait_for(const std::string& text) const {
  return wait_until([&] { return err().find(text) != std::string::npos; });
}

Outcome Process::wait() {
  int status = 0;
  const bool ended = wait_until([&] { return waitpid(process_, &status, WNOHANG) == process_; });
  if (!ended) {
    ADD_FAILURE() << "still running: " << command_;
    return {};
  }
  process_ = -1;
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(streams_ / "out"),
          err(), command_};
}

Outcome becalm(const std::vector<std::string>& arguments) {
  return Process(arguments).wait();
}

Outcome becalm_redirected(const std::vector<std::string>& arguments, const std::string& redirection) {
  return Process(arguments, "exec \"$0\" \"$@\" " + redirection).wait();
}

Outcome becalm_done(const std::vector<std::string>& arguments) {
  Outcome outcome = becalm(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.command << "\n" << outcome.err;
  return outcome;
}

bool has_option(const std::vector<std::string>& arguments, const std::string& name) {
  return std::find(arguments.begin(), arguments.end(), name) != arguments.end();
}

bool wait_until(const std::function<bool()>& condition) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::seconds(60); Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

void write_text(const std::string& path, const std::string& text) {
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path) << text;
}

std::string write_scene(const TempFolder& folder) {
  std::string path = folder / "scene.json";
  write_text(path, R"({
    "frames": {"first": 1, "last": 4},
    "film": {"width": 48, "height": 32},
    "integrator": {"max_depth": 3},
    "camera": {"fov_y_deg": 40, "look_at": {"eye": [0, 2, 6], "target": [0, 0.5, 0]}},
    "environment": {"radiance": [0.1, 0.1, 0.2]},
    "materials": {
      "plaster": {"type": "diffuse", "reflectance": [0.7, 0.6, 0.5]},
      "red": {"type": "diffuse", "reflectance": [0.8, 0.1, 0.1]}
    },
    "meshes": {"plane": {"shape": "rectangle"}, "ball": {"shape": "sphere", "segments": 16}},
    "objects": [
      {"name": "floor", "mesh": "plane", "material": "plaster", "transform": {"scale": 4}},
      {"name": "ball", "mesh": "ball", "material": "red", "transform": {"interpolation": "linear", "keys": [
        {"frame": 1, "translate": [-1, 1, 0]}, {"frame": 4, "translate": [1, 1, 0]}]}},
      {"name": "lamp", "mesh": "plane", "material": "plaster", "emission": [8, 8, 7],
       "transform": {"translate": [1, 4, 1], "rotate_deg": [180, 0, 0]}}
    ]
  })");
  return path;
}

Frame noise_frame(int number, int width, int height) {
  Frame frame(number, width, height);
  std::uint32_t count = static_cast<std::uint32_t>(number) * 0x9e3779b9u;
  for (float& value : frame.add(Aov::beauty).data()) value = 0.25f + 0.5f * random_unit(count++);
  for (float& value : frame.add(Aov::albedo).data()) value = random_unit(count++);
  frame.add(Aov::normal, 0.5f);
  return frame;
}

AovSet all_aovs() {
  return AovSet().set();
}

void write_shares(const std::string& path, const Frame& frame, const std::map<std::string, float>& shares,
                  const std::vector<std::string>& views) {
  Imf::Header header(frame.width(), frame.height());
  if (!views.empty()) Imf::addMultiView(header, views);
  Imf::FrameBuffer buffer;
  std::map<std::string, std::vector<float>> layers;
  for (const auto& [layer, share] : shares) {
    std::vector<float>& pixels = layers[layer];
    for (const float value : frame.image(Aov::beauty).data()) pixels.push_back(share * value);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string name = layer + "RGB"[c];
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      buffer.insert(
          name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data() + c), 16, 16 * frame.width()));
    }
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(frame.height());
}

Frame read_frame(const std::string& path, AovSet aovs) {
  return io::read_exr(path, 0, aovs).frame;
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string frame_path(const std::string& pattern, int frame) {
  return io::SequencePattern(pattern).path(frame);
}

bool same_pixels(const Image& a, const Image& b) {
  return a.same_shape(b) && std::memcmp(a.data().data(), b.data().data(), a.data().size_bytes()) == 0;
}

void expect_same_beauty(const std::string& pattern_a, const std::string& pattern_b, int first, int last) {
  for (int frame = first; frame <= last; ++frame) {
    const Frame a = read_frame(frame_path(pattern_a, frame));
    const Frame b = read_frame(frame_path(pattern_b, frame));
    EXPECT_TRUE(same_pixels(a.image(Aov::beauty), b.image(Aov::beauty)))
        << "frame " << frame << " of " << pattern_a << " and " << pattern_b;
  }
}

void expect_error(const Outcome& outcome, int status, const std::vector<std::string>& words) {
  const std::string context = outcome.command + "\n" + outcome.err;
  EXPECT_EQ(outcome.status, status) << context;
  EXPECT_EQ(outcome.err.rfind("becalm: error: ", 0), 0u) << context;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << context;
  EXPECT_TRUE(outcome.out.empty()) << context << outcome.out;
  for (const std::string& word : words)
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word << "\n" << context;
}

}  // namespace becalm::test
