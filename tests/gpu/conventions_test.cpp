// Kernels that break a convention of shaders/README.md stop the build with one line that names kernel and
// convention.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace {

struct Outcome {
  int status = -1;
  std::string output;
};

Outcome run(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  char buffer[256];
  while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) outcome.output += buffer;
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

class Conventions : public ::testing::Test {
 protected:
  Conventions()
      : folder_(std::filesystem::temp_directory_path() / ("becalm_conventions." + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Conventions() override { std::filesystem::remove_all(folder_); }

  Outcome embed(const std::string& declarations, const std::string& body = "") const {
    std::ofstream(folder_ / "k.comp") << "#version 460\n"
                                      << declarations << "\nvoid main() {" << body << "}\n";
    const std::string path = (folder_ / "k").string();
    const Outcome compiled =
        run(GLSLANG_VALIDATOR " -V --quiet --target-env vulkan1.3 -o " + path + ".spv " + path + ".comp");
    EXPECT_EQ(compiled.status, 0) << compiled.output;
    return run(EMBED_SPIRV " " + table().string() + " kernels odd/k " + path + ".spv");
  }
  void expect_rejected(const std::string& message, const std::string& declarations,
                       const std::string& body = "") const {
    const Outcome outcome = embed(declarations, body);
    EXPECT_EQ(outcome.output, "shader odd/k.comp: " + message + "\n");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_FALSE(std::filesystem::exists(table()));
  }
  std::filesystem::path table() const { return folder_ / "table.cpp"; }

  std::filesystem::path folder_;
};

const std::string kSize = "layout(local_size_x = 8) in;\n";
const std::string kGood = kSize + "layout(set = 0, binding = 0) writeonly buffer B { float data[]; } made;\n";

TEST_F(Conventions, AcceptAKernelThatKeepsThem) {
  const Outcome outcome = embed(kGood, "made.data[0] = 1.0;");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.output, "");
  std::stringstream text;
  text << std::ifstream(table()).rdbuf();
  EXPECT_NE(text.str().find("{\"made\", 0, \"float\", false, true}"), std::string::npos);
  EXPECT_NE(text.str().find("{\"odd/k\", kWords0, kBindings0, {}, {}, 0, 0, std::nullopt, {8, 1, 1}}"),
            std::string::npos);
}

TEST_F(Conventions, WantOneNamedBufferARole) {
  expect_rejected("buffer block 'B' needs an instance name, which names its role",
                  kSize + "layout(binding = 0) buffer B { float data[]; };", "data[0] = 1.0;");
  expect_rejected("buffers 'a' and 'b' share one binding number",
                  kSize +
                      "layout(binding = 0) buffer A { float data[]; } a;\n"
                      "layout(binding = 0) buffer B { float data[]; } b;",
                  "a.data[0] = b.data[0];");
  expect_rejected("has no storage buffer", kSize);
  expect_rejected("buffer 'b': arrays of buffers are not supported",
                  kSize + "layout(binding = 0) buffer B { float data[]; } b[2];", "b[0].data[0] = 1.0;");
}

TEST_F(Conventions, WantBuffersInSetZero) {
  expect_rejected("buffer 'b': must be in set 0",
                  kSize + "layout(set = 1, binding = 0) buffer B { float data[]; } b;", "b.data[0] = 1.0;");
}

TEST_F(Conventions, WantBuffersOfOneArrayOfKnownElements) {
  const auto buffer = [](const std::string& members) {
    return kSize + "layout(binding = 0) buffer B { " + members + " } b;";
  };
  for (const char* element : {"vec3", "int", "uint", "uvec2", "mat4"}) {
    expect_rejected("buffer 'b': elements must be float, vec2 or vec4",
                    buffer(std::string(element) + " data[];"));
  }
  expect_rejected("buffer 'b': must hold one array `data[]` and nothing else",
                  buffer("uint count; float data[];"));
  expect_rejected("buffer 'b': must hold one array `data[]` without a size", buffer("float data[4];"));
  expect_rejected("buffer 'b': must hold one array `data[]` without a size", buffer("float data;"));
  expect_rejected("buffer 'b': is neither read nor written",
                  kSize + "layout(binding = 0) readonly writeonly buffer B { float data[]; } b;");
}

TEST_F(Conventions, WantNothingButBuffersAndPushConstants) {
  const std::string message =
      "images, samplers and uniform buffers are not supported: use storage buffers, texel buffers and "
      "push constants";
  expect_rejected(message, kGood + "layout(binding = 1, r32f) uniform image2D image;",
                  "imageStore(image, ivec2(0), vec4(1.0));");
  const std::string sampler = "texel buffer 'image': of images and samplers only samplerBuffer is supported";
  expect_rejected(sampler, kGood + "layout(binding = 1) uniform sampler2D image;",
                  "made.data[0] = textureLod(image, vec2(0.0), 0.0).x;");
  for (const char* type : {"isamplerBuffer", "usamplerBuffer"}) {
    expect_rejected(sampler, kGood + "layout(binding = 1) uniform " + type + " image;",
                    "made.data[0] = float(texelFetch(image, 0).x);");
  }
  expect_rejected("texel buffer 'texels': must be in set 0",
                  kGood + "layout(set = 1, binding = 1) uniform samplerBuffer texels;",
                  "made.data[0] = texelFetch(texels, 0).x;");
  expect_rejected(message, kGood + "layout(binding = 1) uniform U { float x; } u;", "made.data[0] = u.x;");
}

TEST_F(Conventions, WantPushConstantsOfFourByteScalarsInAHundredAndTwentyEightBytes) {
  expect_rejected("push constants take 132 bytes, more than the 128 that every device has",
                  kGood + "layout(push_constant) uniform P { float values[33]; } p;",
                  "made.data[0] = p.values[3];");
  expect_rejected("push constant 's.scale' must be a 4-byte scalar",
                  kGood + "struct S { int width; vec2 scale; };\nlayout(push_constant) uniform P { S s; } p;",
                  "made.data[0] = p.s.scale.x;");
  expect_rejected("push constant 'scale' must be a 4-byte scalar",
                  kGood + "layout(push_constant) uniform P { vec2 scale; } p;", "made.data[0] = p.scale.x;");
}

TEST_F(Conventions, WantSizesThatNameABufferBeforeOtherPushConstants) {
  const auto block = [](const std::string& members) {
    return kGood + "layout(push_constant) uniform P { " + members + " } p;";
  };
  for (const char* name : {"sizes", "made_extent", "other_size", "_size"}) {
    expect_rejected(
        "push constant '" + std::string(name) + "' must be `size` or `NAME_size` of a buffer NAME",
        block("ivec2 " + std::string(name) + ";"), "made.data[0] = float(p." + std::string(name) + ".x);");
  }
  expect_rejected("push constant 'made_size' must come before those that are no sizes",
                  block("ivec2 size; int count; ivec2 made_size;"), "made.data[0] = float(p.count);");
}

TEST_F(Conventions, WantKernelsWithAFirstRowToBeMadeRowByRow) {
  const auto block = [](const std::string& members) {
    return "layout(push_constant) uniform P { " + members + " } p;\n";
  };
  const std::string use = "made.data[0] = float(p.first_row);";
  EXPECT_EQ(embed(kGood + block("ivec2 size; int first_row; int count;"), use).output, "");
  std::stringstream text;
  text << std::ifstream(table()).rdbuf();
  EXPECT_NE(text.str().find("kSizes0, 12, 16, 8, {8, 1, 1}}"), std::string::npos) << text.str();
  std::filesystem::remove(table());
  expect_rejected("push constant 'first_row' must be int", kGood + block("float first_row;"), use);
  expect_rejected("push constant 'first_row' must come before those that passes declare",
                  kGood + block("ivec2 size; int count; int first_row;"), use);
  expect_rejected(
      "buffer 'fine': next to first_row what is only read must be a texel buffer",
      kGood + block("int first_row;") + "layout(binding = 1) readonly buffer F { float data[]; } fine;",
      "made.data[0] = fine.data[p.first_row];");
  expect_rejected("next to first_row local_size_y must be 1, so that bands have no partial workgroups",
                  "layout(local_size_y = 8) in;\n" + kGood.substr(kSize.size()) + block("int first_row;"),
                  use);
}

TEST_F(Conventions, WantLiteralWorkgroupSizes) {
  expect_rejected("local_size must be a literal, not a constant_id",
                  "layout(local_size_x_id = 0) in;\nlayout(binding = 0) buffer B { float data[]; } b;",
                  "b.data[0] = 1.0;");
}

TEST_F(Conventions, WantSpecializationConstantsOfTypeInt) {
  for (const char* constant : {"uint c = 1u", "float c = 1.0", "bool c = true"}) {
    expect_rejected("specialization constant 'c' must be int",
                    kGood + "layout(constant_id = 0) const " + constant + ";", "made.data[0] = float(c);");
  }
}

TEST_F(Conventions, WantCapabilitiesTheDeviceEnables) {
  expect_rejected("needs SPIR-V capability 10, which filter/gpu/device.cpp does not enable", kGood,
                  "double x = double(made.data.length()); made.data[0] = float(x * x);");
}

}  // namespace
