// Feeds bytes to the loader of suites. What it refuses is told by Error(bad_input) with the file's name in
// front; what it loads can be run.
#include <cstdlib>
#include <string>

#include "app/test/suite.h"
#include "frame/error.h"
#include "frame/io/sequence.h"
#include "tests/scratch_folder.h"

namespace {

using becalm::app::TestCase;

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const TestCase& test, const std::string& folder) {
  require(test.source.scene.empty() != test.source.command.empty());
  require(!test.source.frames.empty());
  require(!test.judges.empty());
  require(test.reference_folder == folder + "/references/" + test.name);
  for (const int which : {0, 1}) {
    require(becalm::io::SequencePattern(test.reference_pattern(which)).path(test.source.frames.front()) !=
            test.reference_folder);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const becalm::ScratchFolder folder;
  static const std::string scene = folder.write("scene.json", "{}");
  const std::string suite = folder.write("suite.json", data, size);
  try {
    for (const TestCase& test : becalm::app::load_suites({suite})) {
      check(test, suite.substr(0, suite.rfind('/')));
    }
  } catch (const becalm::Error& error) {
    require(error.status() == becalm::ExitStatus::bad_input);
    require(std::string(error.what()).starts_with(suite));
  }
  return 0;
}
