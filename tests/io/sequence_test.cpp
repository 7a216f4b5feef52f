#include "frame/io/sequence.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "frame/error.h"
#include "frame/io/frame_range.h"
#include "tests/error_of.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

using Frames = std::vector<int>;

TEST(FrameRange, NumbersRangesStepsAndLists) {
  EXPECT_EQ(parse_frame_range("5"), Frames{5});
  EXPECT_EQ(parse_frame_range("1-4"), (Frames{1, 2, 3, 4}));
  EXPECT_EQ(parse_frame_range("7-7"), Frames{7});
  EXPECT_EQ(parse_frame_range("1-10x4"), (Frames{1, 5, 9}));
  EXPECT_EQ(parse_frame_range("1-3x10"), Frames{1});
  EXPECT_EQ(parse_frame_range("1-2,20-21"), (Frames{1, 2, 20, 21}));
  EXPECT_EQ(parse_frame_range("0007"), Frames{7});
}

TEST(FrameRange, NegativeFrames) {
  EXPECT_EQ(parse_frame_range("-3"), Frames{-3});
  EXPECT_EQ(parse_frame_range("-3-1"), (Frames{-3, -2, -1, 0, 1}));
  EXPECT_EQ(parse_frame_range("-4--2"), (Frames{-4, -3, -2}));
  EXPECT_EQ(parse_frame_range("-6--1x3,2"), (Frames{-6, -3, 2}));
}

TEST(FrameRange, ResultAscendsWithoutDuplicates) {
  EXPECT_EQ(parse_frame_range("9,1-3,2,2-4"), (Frames{1, 2, 3, 4, 9}));
}

TEST(FrameRange, ErrorsNameTheTextAndTheReason) {
  const auto error = [](std::string_view text) {
    return error_of(ExitStatus::usage, [&] { parse_frame_range(text); });
  };
  EXPECT_EQ(
      error("9-1"),
      "frame range '9-1': the range descends from 9 to 1; expected such as 1-100, 1-100x2, 5 or 1-10,20-30");
  EXPECT_NE(error("1-9x0").find("'1-9x0': the step 0 is below 1"), std::string::npos);
  EXPECT_NE(error("1-9x-2").find("the step -2 is below 1"), std::string::npos);
  EXPECT_NE(error("").find("no frame number at its end"), std::string::npos);
  EXPECT_NE(error("abc").find("no frame number at 'abc'"), std::string::npos);
  EXPECT_NE(error("1-").find("no last frame number at its end"), std::string::npos);
  EXPECT_NE(error("1-b").find("no last frame number at 'b'"), std::string::npos);
  EXPECT_NE(error("1-5x").find("no step at its end"), std::string::npos);
  EXPECT_NE(error("1,,2").find("no frame number at ',2'"), std::string::npos);
  EXPECT_NE(error("1-5 ").find("' ' was not expected"), std::string::npos);
  EXPECT_NE(error("5x2").find("'x2' was not expected"), std::string::npos);
  EXPECT_NE(error("99999999999").find("no frame number"), std::string::npos);
  EXPECT_NE(error("1-2000000000").find("more than 1000000 frames"), std::string::npos);
  EXPECT_NE(error("-2147483648-2147483647").find("more than 1000000 frames"), std::string::npos);
}

TEST(FrameRange, HasAStepIfAllOfItDoes) {
  EXPECT_EQ(frame_range_step("1-100x2"), 2);
  EXPECT_EQ(frame_range_step("7-7x2"), 2);
  EXPECT_EQ(frame_range_step("1-9x2,21-29x2"), 2);
  EXPECT_EQ(frame_range_step("1-9x2,21-30x3"), 1);
  EXPECT_EQ(frame_range_step("1-9x2,12-20x2"), 1);
  EXPECT_EQ(frame_range_step("9-15x3,-6-0x3"), 3);
  EXPECT_EQ(frame_range_step("1-9x2,11"), 1);
  EXPECT_EQ(frame_range_step("1,3,5"), 1);
  EXPECT_EQ(frame_range_step("1-4"), 1);
}

TEST(FrameRange, FormattedRangesParseToTheSameFrames) {
  EXPECT_EQ(format_frame_range({}), "");
  EXPECT_EQ(format_frame_range({5}), "5");
  EXPECT_EQ(format_frame_range({1, 2}), "1,2");
  EXPECT_EQ(format_frame_range({1, 2, 3, 7}), "1-3,7");
  EXPECT_EQ(format_frame_range({1, 3, 5, 6, 7, 8}), "1-5x2,6-8");
  EXPECT_EQ(format_frame_range({-4, -3, -2, 10}), "-4--2,10");
  EXPECT_EQ(format_frame_range({1, 3, 4, 5}), "1,3-5");
  for (const Frames& frames : {Frames{-9, -6, -3, 0, 1, 2, 4, 8, 16, 17, 18}, Frames{1, 10, 100},
                               Frames{-1, 0}, Frames{-2147483647, 0, 2147483647}}) {
    EXPECT_EQ(parse_frame_range(format_frame_range(frames)), frames) << format_frame_range(frames);
  }
}

TEST(FrameRange, FormattedRangesOfAShotHaveItsStep) {
  EXPECT_EQ(format_frame_range({}, 1), "");
  EXPECT_EQ(format_frame_range({1, 3}, 1), "1,3");
  EXPECT_EQ(format_frame_range({1, 3, 5}, 1), "1,3,5");
  EXPECT_EQ(format_frame_range({1, 3, 5, 7}, 1), "1,3-7x2");
  EXPECT_EQ(format_frame_range({1, 2, 3, 5, 7, 9}, 1), "1-3,5-9x2");
  EXPECT_EQ(format_frame_range({1, 3, 5}, 2), "1-5x2");
  EXPECT_EQ(format_frame_range({7}, 2), "7-7x2");
  EXPECT_EQ(format_frame_range({-3, -1, 5}, 2), "-3--1x2,5-5x2");
  EXPECT_EQ(format_frame_range({1, 4, 6}, 2), "1,4,6");
  EXPECT_EQ(format_frame_range({1, 3, 5}, 4), "1,3,5");
  for (const int step : {1, 2, 3}) {
    for (const Frames& frames : {Frames{-9, -3, 3}, Frames{0, 6, 12, 18}, Frames{7}, Frames{1, 7, 13, 37}}) {
      const std::string text = format_frame_range(frames, step);
      EXPECT_EQ(parse_frame_range(text), frames) << text;
      EXPECT_EQ(frame_range_step(text), step) << text;
    }
  }
}

TEST(FrameInName, IsTheLastNumberBetweenDotsOrTheDigitsAtTheEnd) {
  const auto number = [](const std::string& path) {
    const std::optional<NamedFrame> frame = frame_in_name(path);
    return frame ? std::pair(frame->number, frame->padding) : std::pair(0, 0);
  };
  EXPECT_EQ(number("in.0052.exr"), std::pair(52, 4));
  EXPECT_EQ(number("v02/shot.7.exr"), std::pair(7, 1));
  EXPECT_EQ(number("shot.-001.exr"), std::pair(-1, 4));
  EXPECT_EQ(number("shot.0052.calm.exr"), std::pair(52, 4));
  EXPECT_EQ(number("shot_v02.0003.exr"), std::pair(3, 4));
  EXPECT_EQ(number("shot_0052.exr"), std::pair(52, 4));
  EXPECT_EQ(number("shot-0052.exr"), std::pair(52, 4));
  EXPECT_EQ(number("Image0052.exr"), std::pair(52, 4));
  EXPECT_EQ(number("0052.exr"), std::pair(52, 4));
  EXPECT_EQ(number("conv0012.exr"), std::pair(12, 4));
  for (const char* name : {"still.exr", "shot_v02.exr", "v3.exr", "room_640x360.exr", "0052/still.exr",
                           "shot.99999999999.exr", "room4k.exr", ".exr", ""}) {
    EXPECT_EQ(number(name), std::pair(0, 0)) << name;
  }
}

TEST(SequencePattern, Fields) {
  EXPECT_EQ(SequencePattern("a/shot.####.exr").path(12), "a/shot.0012.exr");
  EXPECT_EQ(SequencePattern("shot.@@@.exr").path(12), "shot.012.exr");
  EXPECT_EQ(SequencePattern("shot.%04d.exr").path(12), "shot.0012.exr");
  EXPECT_EQ(SequencePattern("shot.%d.exr").path(12), "shot.12.exr");
  EXPECT_EQ(SequencePattern("shot.$F4.exr").path(12), "shot.0012.exr");
  EXPECT_EQ(SequencePattern("shot.$F.exr").path(12), "shot.12.exr");
  EXPECT_EQ(SequencePattern("####").path(3), "0003");
  EXPECT_EQ(SequencePattern("shot.####.exr").text(), "shot.####.exr");
}

TEST(SequencePattern, LongAndNegativeNumbers) {
  EXPECT_EQ(SequencePattern("shot.##.exr").path(12345), "shot.12345.exr");
  EXPECT_EQ(SequencePattern("shot.####.exr").path(-1), "shot.-001.exr");
  EXPECT_EQ(SequencePattern("shot.%d.exr").path(-1), "shot.-1.exr");
}

TEST(SequencePattern, TextWithoutField) {
  for (const char* text :
       {"still.exr", "100%.exr", "a%4d.exr", "$HOME.exr", "$G4.exr", "%s.exr", "%04x.exr", ""}) {
    const SequencePattern pattern(text);
    EXPECT_FALSE(pattern.has_frame_field()) << text;
    EXPECT_EQ(pattern.path(7), text);
    EXPECT_TRUE(pattern.frames_on_disk().empty());
  }
  EXPECT_TRUE(SequencePattern("a.#.exr").has_frame_field());
}

TEST(SequencePattern, ALoneFieldBeforeALetterOrDigitIsText) {
  for (const char* text : {"me@home.exr", "50%done.exr", "$FOO.exr", "me@2.exr"})
    EXPECT_FALSE(SequencePattern(text).has_frame_field()) << text;
  EXPECT_EQ(SequencePattern("me@home.####.exr").path(7), "me@home.0007.exr");
  for (const char* text : {"shot.@.exr", "shot@.exr", "shot%d.exr", "shot_$F_left.exr", "shot$F"})
    EXPECT_TRUE(SequencePattern(text).has_frame_field()) << text;
}

TEST(SequencePattern, ALoneNumberSignBesideALongerFieldIsText) {
  EXPECT_EQ(SequencePattern("take#2.####.exr").path(7), "take#2.0007.exr");
  EXPECT_EQ(SequencePattern("shot.%04d.#1#.exr").path(7), "shot.0007.#1#.exr");
  EXPECT_EQ(error_of(ExitStatus::usage, [] { SequencePattern("take#2.#.exr"); }),
            "file pattern 'take#2.#.exr': two frame fields, '#' and '#'; expected one at most");
}

TEST(SequencePattern, FoldersHoldNoField) {
  EXPECT_EQ(SequencePattern("me@home/v%02d/shot.##.exr").path(3), "me@home/v%02d/shot.03.exr");
}

TEST(SequencePattern, IsOfFilesWithNumbersOfAnyWidth) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(patterns_of_files(Names{"in/s.0009.exr", "in/s.0010.exr"}), (Names{"in/s.####.exr"}));
  EXPECT_EQ(patterns_of_files(Names{"s.9.exr", "s.10.exr", "s.11.exr"}), (Names{"s.#.exr"}));
  EXPECT_EQ(patterns_of_files(Names{"b.exr", "a.1.exr", "a.2.exr"}), (Names{"a.#.exr", "b.exr"}));
}

TEST(SequencePattern, TwoFieldsAreAnError) {
  EXPECT_EQ(error_of(ExitStatus::usage, [] { SequencePattern("shot.####.%d.exr"); }),
            "file pattern 'shot.####.%d.exr': two frame fields, '####' and '%d'; expected one at most");
}

class OnDisk : public ::testing::Test {
 protected:
  void touch(const std::string& name) { std::ofstream(folder_.path(name)) << 'x'; }

  TemporaryFolder folder_;
};

TEST_F(OnDisk, FramesThatExist) {
  for (const char* name :
       {"shot.0003.exr", "shot.0001.exr", "shot.-002.exr", "shot.12.exr", "shot.12345.exr", "shot.00004.exr",
        "shot.000a.exr", "shot.0005.png", "other.0006.exr", "shot..exr", "shot.0001.exr.partial.12.0"}) {
    touch(name);
  }
  EXPECT_EQ(SequencePattern(folder_.path("shot.####.exr")).frames_on_disk(), (Frames{-2, 1, 3, 12345}));
  EXPECT_EQ(SequencePattern(folder_.path("shot.%d.exr")).frames_on_disk(), (Frames{12, 12345}));
  EXPECT_TRUE(SequencePattern(folder_.path("none.####.exr")).frames_on_disk().empty());
  EXPECT_TRUE(SequencePattern(folder_.path("no_folder/shot.####.exr")).frames_on_disk().empty());
}

TEST_F(OnDisk, NegativeNumbersMayHaveTheirSignBeforeThePadding) {
  for (const char* name : {"shot.-0012.exr", "shot.-0001.exr", "shot.0000.exr", "shot.0001.exr"}) touch(name);
  for (const char* text : {"shot.####.exr", "shot.#.exr"}) {
    const SequencePattern pattern(folder_.path(text));
    EXPECT_EQ(pattern.frames_on_disk(), (Frames{-12, -1, 0, 1})) << text;
    EXPECT_EQ(pattern.path(-3), folder_.path("shot.-0003.exr"));
    EXPECT_EQ(pattern.path(3), folder_.path("shot.0003.exr"));
  }
  SequencePattern output(folder_.path("empty/out.####.exr"));
  EXPECT_EQ(output.path(-3), folder_.path("empty/out.-003.exr"));
  output.place_sign_as(SequencePattern(folder_.path("shot.####.exr")));
  EXPECT_EQ(output.path(-3), folder_.path("empty/out.-0003.exr"));
  touch("shot.-002.exr");  // both are there: the padding counts the sign
  EXPECT_EQ(SequencePattern(folder_.path("shot.####.exr")).frames_on_disk(), (Frames{-2, 0, 1}));
}

TEST_F(OnDisk, ALoneFieldLeavesNoFrameOfAnotherPaddingOut) {
  for (const char* name : {"shot.1.exr", "shot.2.exr", "shot.0003.exr", "shot.0004.exr"}) touch(name);
  const SequencePattern pattern(folder_.path("shot.#.exr"));
  const std::string error = error_of(ExitStatus::bad_input, [&] { pattern.frames_on_disk(); });
  EXPECT_NE(error.find(folder_.path("shot.0004.exr") + " and "), std::string::npos) << error;
  EXPECT_NE(error.find("padded differently"), std::string::npos) << error;
  EXPECT_EQ(SequencePattern(folder_.path("shot.%d.exr")).frames_on_disk(), (Frames{1, 2}));
  EXPECT_EQ(SequencePattern(folder_.path("shot.####.exr")).frames_on_disk(), (Frames{3, 4}));
}

TEST_F(OnDisk, HintsAtNumbersOfAnotherPadding) {
  const SequencePattern pattern(folder_.path("shot.####.exr"));
  EXPECT_EQ(pattern.hint_where_missing(), "");
  touch("shot.2.exr");
  EXPECT_EQ(pattern.hint_where_missing(),
            "; " + folder_.path("shot.2.exr") + " is there, and " + folder_.path("shot.#.exr") + " finds it");
  touch("shot.0001.exr");
  EXPECT_EQ(pattern.hint_where_missing(), "; " + folder_.path("shot.2.exr") + " has another padding");
}

TEST_F(OnDisk, ALoneFieldInTheNameOfAFileIsText) {
  for (const char* name : {"me@.exr", "50%d.exr", "take#.exr", "shot.####.exr", "shot.$F4.exr"}) {
    const std::string path = folder_.path(name);
    EXPECT_TRUE(SequencePattern(path).has_frame_field()) << name;
    touch(name);
    const bool is_lone = !std::string(name).starts_with("shot");
    EXPECT_EQ(SequencePattern(path).has_frame_field(), !is_lone) << name;
  }
}

TEST_F(OnDisk, TellsWhatALoneFieldStandsFor) {
  EXPECT_EQ(SequencePattern(folder_.path("me@.exr")).hint_where_missing(),
            "; '@' stands for the frame number");
  EXPECT_EQ(SequencePattern(folder_.path("me@@.exr")).hint_where_missing(), "");
}

TEST_F(OnDisk, AFolderThatCannotBeListedIsAnError) {
  const std::string loop = folder_.path("loop");
  std::filesystem::create_symlink(loop, loop);
  EXPECT_EQ(
      error_of(ExitStatus::bad_input, [&] { SequencePattern(loop + "/shot.####.exr").frames_on_disk(); }),
      loop + "/: folder cannot be listed: Too many levels of symbolic links");
}

TEST_F(OnDisk, LoneHashMayBeGivenItsPadding) {
  touch("shot.0998.exr");
  EXPECT_EQ(SequencePattern(folder_.path("shot.#.exr"), 2).path(7), folder_.path("shot.07.exr"));
  EXPECT_EQ(SequencePattern(folder_.path("shot.###.exr"), 2).path(7), folder_.path("shot.007.exr"));
}

TEST_F(OnDisk, LoneHashTakesThePaddingOfTheFiles) {
  EXPECT_EQ(SequencePattern(folder_.path("shot.#.exr")).path(7), folder_.path("shot.7.exr"));
  touch("shot.0998.exr");
  touch("shot.0999.exr");
  touch("shot.1000.exr");
  const SequencePattern padded(folder_.path("shot.#.exr"));
  EXPECT_EQ(padded.path(7), folder_.path("shot.0007.exr"));
  EXPECT_EQ(padded.frames_on_disk(), (Frames{998, 999, 1000}));
}

TEST_F(OnDisk, FramesPaddedWiderThanThePatternAreNotLeftOutSilently) {
  for (const char* name : {"shot.0998.exr", "shot.0999.exr", "shot.1000.exr", "shot.1001.exr"}) touch(name);
  for (const char* pattern : {"shot.%d.exr", "shot.$F.exr", "shot.###.exr"}) {
    const SequencePattern narrow(folder_.path(pattern));
    const std::string error = error_of(ExitStatus::bad_input, [&] { narrow.refuse_wider_numbers(); });
    EXPECT_NE(error.find("exr would be left out"), std::string::npos) << error;
    EXPECT_NE(error.find("write #### to take both"), std::string::npos) << error;
  }
  const SequencePattern wide(folder_.path("shot.####.exr"));
  EXPECT_EQ(wide.frames_on_disk(), (Frames{998, 999, 1000, 1001}));
  wide.refuse_wider_numbers();
  // Another sequence beside it, of the same numbers, is none of it.
  for (const char* name : {"shot.998.exr", "shot.999.exr"}) touch(name);
  const SequencePattern unpadded(folder_.path("shot.%d.exr"));
  EXPECT_EQ(unpadded.frames_on_disk(), (Frames{998, 999, 1000, 1001}));
  unpadded.refuse_wider_numbers();
}

TEST_F(OnDisk, LoneHashOverUnpaddedFiles) {
  touch("a_9.exr");
  touch("a_10.exr");
  const SequencePattern pattern(folder_.path("a_#.exr"));
  EXPECT_EQ(pattern.path(3), folder_.path("a_3.exr"));
  EXPECT_EQ(pattern.frames_on_disk(), (Frames{9, 10}));
}

}  // namespace
}  // namespace becalm::io
