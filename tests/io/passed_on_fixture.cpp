#include "tests/io/passed_on_fixture.h"

#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <string_view>

namespace becalm::io {
namespace {

/// Keeps an attribute's value as it is stored in a file.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : OStream("memory") {}
  void write(const char* bytes, int size) override { bytes_.append(bytes, static_cast<std::size_t>(size)); }
  std::uint64_t tellp() override { return bytes_.size(); }
  void seekp(std::uint64_t) override {}
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string text_of(const Imf::Attribute& attribute) {
  MemoryStream stream;
  attribute.writeValueTo(stream, 2);
  return stream.bytes();
}

}  // namespace

WriteReport PassedOn::denoise(AovSet diagnostics, const LayerOverrides& overrides,
                              const DenoisedFormat& format) {
  const auto write = [&](const std::string& result, AovSet wanted, KeepPassedOn keep) {
    LoadedFrame loaded =
        read_exr(source_, 1, wanted, {.layers = overrides}, LightGroups::leave, std::nullopt, keep);
    for (float& value : loaded.frame.image(Aov::beauty).data()) value = 2.0f * value + 1.0f;
    for (const AovInfo& entry : kAovTable) {
      if (diagnostics.test(static_cast<std::size_t>(entry.aov))) loaded.frame.add(entry.aov, 0.3f);
    }
    layers_ = loaded.layers;
    return write_denoised_exr(result, loaded.frame, {}, loaded, {{"becalm:preset", "final"}}, format);
  };
  const WriteReport report = write(result_, {}, KeepPassedOn::no);
  const std::string of_kept = folder_.path("out/of_kept.exr");
  write(of_kept, AovSet().set(static_cast<std::size_t>(Aov::depth)), KeepPassedOn::yes);
  EXPECT_EQ(read_bytes(of_kept), read_bytes(result_));
  return report;
}

void PassedOn::expect_same_but_for(const std::vector<std::string>& replaced, int part) const {
  const Planes before = read_planes(source_, part);
  const Planes after = read_planes(result_, part);
  for (const auto& [name, bytes] : before) {
    ASSERT_TRUE(after.contains(name)) << name;
    const bool is_replaced = std::find(replaced.begin(), replaced.end(), name) != replaced.end();
    EXPECT_EQ(after.at(name) == bytes, !is_replaced) << name;
  }
}

void PassedOn::expect_same_header(int part, const std::vector<std::string>& but_for) const {
  const Imf::Header before = read_header(source_, part);
  const Imf::Header after = read_header(result_, part);
  for (auto it = before.begin(); it != before.end(); ++it) {
    const std::string name = it.name();
    if (name == "channels" || std::find(but_for.begin(), but_for.end(), name) != but_for.end()) continue;
    const Imf::Attribute* other = after.find(it.name()) == after.end() ? nullptr : &after[it.name()];
    ASSERT_NE(other, nullptr) << name;
    EXPECT_STREQ(other->typeName(), it.attribute().typeName()) << name;
    EXPECT_EQ(text_of(*other), text_of(it.attribute())) << name;
  }
  for (auto it = after.begin(); it != after.end(); ++it) {
    if (std::string_view(it.name()).starts_with("becalm:")) continue;
    EXPECT_TRUE(before.find(it.name()) != before.end()) << it.name() << " was added";
  }
}

void add_attributes_of_a_part(Imf::Header& header) {
  header.insert("cryptomatte/1a2b3c4/manifest", Imf::StringAttribute("{\"ball\":\"7fc12345\"}"));
  header.insert("cryptomatte/1a2b3c4/name", Imf::StringAttribute("CryptoObject"));
  header.insert("exposure", Imf::FloatAttribute(1.5f));
  Imf::addOwner(header, "somebody");
}

void add_attributes(Imf::Header& header) {
  add_attributes_of_a_part(header);
  Imf::addChromaticities(header, Imf::Chromaticities());
  header.pixelAspectRatio() = 1.25f;
}

}  // namespace becalm::io
