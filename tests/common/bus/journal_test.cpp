#include "common/bus/journal.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/base/error.h"
#include "common/base/state_archive.h"
#include "common/bus/channels.h"
#include "common/bus/journal_bus.h"
#include "common/bus/memory_bus.h"
#include "common/bus/publisher.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

std::vector<uint8_t> bytesOf(const std::string& text) {
  return {text.begin(), text.end()};
}

class JournalTest : public ::testing::Test {
 protected:
  void write(const std::vector<std::string>& texts) {
    JournalWriter writer(path, 0);
    for (const std::string& text : texts) writer.append("A", bytesOf(text));
  }
  std::vector<std::string> read() {
    std::vector<std::string> texts;
    JournalReader reader(path);
    while (const auto record = reader.next()) texts.emplace_back(record->bytes.begin(), record->bytes.end());
    left = reader.bytesLeft();
    good = reader.goodBytes();
    return texts;
  }
  void flipBit(int64_t at) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(at);
    const char byte = static_cast<char>(file.get());
    file.seekp(at);
    file.put(static_cast<char>(byte ^ 4));
  }
  test::TempFolder folder;
  std::string path = folder / "x.journal";
  int64_t left = -1, good = -1;
};

TEST_F(JournalTest, TheChecksumIsThatOfTheStandard) {
  EXPECT_EQ(crc32(bytesOf("123456789")), 0xCBF43926u);
  EXPECT_EQ(crc32({}), 0u);
}

TEST_F(JournalTest, WhatWasAppendedIsReadInOrder) {
  write({"one", "", std::string(70000, 'x')});
  EXPECT_EQ(read(), (std::vector<std::string>{"one", "", std::string(70000, 'x')}));
  EXPECT_EQ(left, 0);
}

TEST_F(JournalTest, AJournalThatIsNotThereHasNoRecords) {
  EXPECT_TRUE(read().empty());
  EXPECT_EQ(left, 0);
}

// Whatever is cut off: the records before it stand, and the next life writes behind them.
TEST_F(JournalTest, ATailThatIsCutShortAtAnyByteCostsItsOwnRecordOnly) {
  write({"one", "two", "three"});
  const auto whole = static_cast<int64_t>(std::filesystem::file_size(path));
  const int64_t last = 4 + 2 + 4 + 1 + 5;
  for (int64_t cut = 1; cut < last; ++cut) {
    write({"one", "two", "three"});
    std::filesystem::resize_file(path, static_cast<uintmax_t>(whole - cut));
    EXPECT_EQ(read(), (std::vector<std::string>{"one", "two"})) << cut;
    EXPECT_EQ(left, last - cut);
    JournalWriter(path, good).append("A", bytesOf("four"));
    EXPECT_EQ(read(), (std::vector<std::string>{"one", "two", "four"})) << cut;
  }
}

TEST_F(JournalTest, AFlippedBitAnywhereInARecordEndsTheJournalBeforeIt) {
  const int64_t second = 8 + (4 + 2 + 4 + 1 + 3);
  for (int64_t at = second; at < second + 4 + 2 + 4 + 1 + 3; ++at) {
    write({"one", "two", "three"});
    flipBit(at);
    EXPECT_EQ(read(), std::vector<std::string>{"one"}) << at;
    EXPECT_GT(left, 0);
  }
}

TEST_F(JournalTest, AnotherFileIsNamedAndLeftAlone) {
  std::ofstream(path) << "trajectory of something";
  try {
    read();
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("is no journal"), std::string::npos) << e.what();
  }
}

// Adds up what it hears and says the sum: a node that is a function of what it heard.
class Sum {
 public:
  Sum(MemoryBus& wire, const std::string& path, int64_t every_bytes = 0) : bus(wire, path), publisher(bus) {
    publisher.setSession(7);
    sgraphs::subscribe(
        bus, channels::kPlanesEnd,
        [this](const stream_end_t& m) {
          sum += m.header.utime;
          say();
        },
        [] {});
    bus.onNote("double", [this] {
      sum *= 2;
      say();
    });
    if (every_bytes > 0)
      bus.keepCheckpoints(
          every_bytes,
          [this] {
            StateArchive archive;
            archive(*this);
            return archive.takeBytes();
          },
          [this](Bus::Bytes bytes) { StateArchive{bytes}(*this); });
    resumed = bus.resume();
  }
  void visitState(StateArchive& archive) { archive(publisher, sum); }
  void say() {
    run_result_t out{};
    out.rounds = sum;
    publisher.send(channels::kRunResult, out);
  }
  JournalBus bus;
  Publisher publisher;
  int64_t sum = 0, resumed = 0;
};

class JournalBusTest : public JournalTest {
 protected:
  JournalBusTest() {
    subscribe(
        wire, channels::kRunResult, [this](const run_result_t& m) { said.push_back(m); }, [] {});
  }
  void tell(int64_t value) {
    stream_end_t m{};
    m.header.utime = value;
    publish(wire, channels::kPlanesEnd, m);
    wire.dispatch(0);
  }
  MemoryBus wire;
  std::vector<run_result_t> said;
};

TEST_F(JournalBusTest, AProcessThatWasKilledGoesOnWhereItWasAndSaysItsLastWordAgain) {
  {
    Sum first(wire, path);
    EXPECT_EQ(first.resumed, 0);
    tell(1);
    tell(10);
    first.bus.note("double");
    tell(100);
  }
  MemoryBus second_wire;
  std::vector<run_result_t> heard;
  subscribe(
      second_wire, channels::kRunResult, [&heard](const run_result_t& m) { heard.push_back(m); }, [] {});
  Sum second(second_wire, path);
  second_wire.dispatch(0);
  EXPECT_EQ(second.resumed, 4);
  EXPECT_EQ(second.sum, (1 + 10) * 2 + 100);
  ASSERT_EQ(heard.size(), 1u) << "the last record's answer, which may not have been sent";
  EXPECT_EQ(heard[0].rounds, 122);
  EXPECT_EQ(heard[0].header.seq, 3);
  EXPECT_EQ(heard[0].header.boot, 0);
  second.bus.note("double");
  second_wire.dispatch(0);
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[1].rounds, 244);
  EXPECT_EQ(heard[1].header.seq, 4) << "numbers go on";
  EXPECT_EQ(heard[1].header.boot, 1) << "and tell that there was a restart";
}

TEST_F(JournalBusTest, WithCheckpointsTheJournalStaysSmallAndTellsTheSame) {
  constexpr int64_t kEvery = 1000;
  int64_t sum = 0, longest = 0;
  for (int64_t life = 0; life < 3; ++life) {
    MemoryBus own;
    std::vector<run_result_t> heard;
    subscribe(
        own, channels::kRunResult, [&heard](const run_result_t& m) { heard.push_back(m); }, [] {});
    Sum reader(own, path, kEvery);
    EXPECT_EQ(reader.sum, sum);
    EXPECT_EQ(reader.bus.boot(), life);
    EXPECT_LT(reader.resumed, 20) << "only what came behind the checkpoint";
    own.dispatch(0);
    const size_t repeated = heard.size();
    for (int64_t i = 1; i <= 100; ++i) {
      stream_end_t m{};
      m.header.utime = i;
      publish(own, channels::kPlanesEnd, m);
      own.dispatch(0);
      sum += i;
      longest = std::max(longest, static_cast<int64_t>(std::filesystem::file_size(path)));
    }
    ASSERT_EQ(heard.size(), repeated + 100);
    EXPECT_EQ(heard.back().rounds, sum);
    EXPECT_EQ(heard.back().header.seq, 100 * (life + 1) - 1) << "numbers go on";
    EXPECT_EQ(heard.back().header.boot, life);
  }
  EXPECT_LT(longest, 2 * kEvery);
}

TEST_F(JournalBusTest, ACheckpointThatCannotBeReadEndsTheProcessAndTheJournal) {
  {
    Sum first(wire, path, 100);
    for (int64_t i = 0; i < 20; ++i) tell(i);
  }
  MemoryBus next;
  try {
    // This one keeps none.
    Sum second(next, path);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("keeps no checkpoints"), std::string::npos) << e.what();
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(Sum(next, path).sum, 0) << "and the next one starts anew";
}

TEST_F(JournalBusTest, EveryRestartRaisesBoot) {
  for (int64_t life = 0; life < 4; ++life) {
    MemoryBus own;
    Sum sum(own, path);
    EXPECT_EQ(sum.bus.boot(), life);
  }
}

TEST_F(JournalBusTest, AnEndedSessionLeavesNoJournal) {
  Sum sum(wire, path);
  tell(1);
  EXPECT_TRUE(std::filesystem::exists(path));
  sum.bus.forget();
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(JournalBusTest, WithoutAPathNothingIsWritten) {
  Sum sum(wire, "");
  tell(3);
  EXPECT_EQ(sum.sum, 3);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// A process that slept through the end of its session must not stay in it.
TEST_F(JournalBusTest, AnotherSessionEndsAProcessThatWasResumed) {
  session_t m{};
  const auto play = [&m](MemoryBus& bus, int64_t session) {
    m.header.session = session;
    publish(bus, channels::kSession, m);
    bus.dispatch(0);
  };
  {
    JournalBus first(wire, path);
    first.subscribe("SESSION", [](Bus::Bytes) {});
    first.resume();
    play(wire, 7);
  }
  MemoryBus next;
  JournalBus second(next, path);
  second.subscribe("SESSION", [](Bus::Bytes) {});
  EXPECT_EQ(second.resume(), 1);
  EXPECT_NO_THROW(play(next, 7));
  EXPECT_THROW(play(next, 8), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace sgraphs
