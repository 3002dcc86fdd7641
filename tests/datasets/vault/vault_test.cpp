// SPDX-License-Identifier: Apache-2.0
// Encrypted copies of a store as a whole: datasets/vault.
#include <fcntl.h>
#include <unistd.h>

#include "ltm/store/rewrite.h"
#include "tests/datasets/vault/vault_fixture.h"

namespace engram::datasets::vault {
namespace {

class Vault : public VaultFixture {
 protected:
  /// The packed image of the camera's first snapshot.
  Buffer image_in_store() {
    const auto reader = *ltm::StoreReader::open(store_);
    const auto packed = *reader->read_packed(camera(), (*reader->index(camera()))->front());
    return packed.instances[0].value.media[0].bytes;
  }
};

TEST_F(Vault, GivesBackEqualAnswersAndTypes) {
  make_store();
  const auto out = exported();
  EXPECT_EQ(out.added, 9U);
  EXPECT_EQ(out.snapshots, 3U * kDays * kPerDay);
  EXPECT_TRUE(out.unread.empty());
  EXPECT_TRUE(checked().is_whole());
  const auto back = scratch_ / "back";
  const auto in = imported(back);
  EXPECT_EQ(in.snapshots, out.snapshots);
  EXPECT_EQ(in.instances, out.instances);
  EXPECT_TRUE(in.damaged.empty());
  EXPECT_EQ(answers(store_), answers(back));
  const auto found = answers(back);
  EXPECT_EQ(found.entities().size(), 3U);
  EXPECT_EQ(ltm::read_manifest(store_)->types, ltm::read_manifest(back)->types);
  EXPECT_NE(ltm::read_manifest(back)->types.find(arm().parent()), nullptr);
  expect_whole_store(back);
  const auto summary = *(*ltm::StoreReader::open(back))->summary(camera());
  EXPECT_EQ(summary.offered, 3U * (kPerDay + 3U)) << "with what filters had dropped";
}

TEST_F(Vault, CarriesWhatWasRecordedInThePackedFormThatItHas) {
  make_store();
  exported();
  const auto back = scratch_ / "back";
  imported(back);
  const auto before = *ltm::StoreReader::open(store_), after = *ltm::StoreReader::open(back);
  const auto *entries = *before->index(camera()), *entries_back = *after->index(camera());
  ASSERT_EQ(entries->size(), entries_back->size());
  for (size_t i = 0; i < entries->size(); ++i) {
    const auto packed = *before->read_packed(camera(), (*entries)[i]);
    const auto packed_back = *after->read_packed(camera(), (*entries_back)[i]);
    ASSERT_EQ(packed_back.instances.size(), 1U);
    const auto &medium = packed.instances[0].value.media.at(0),
               &medium_back = packed_back.instances[0].value.media.at(0);
    EXPECT_EQ(medium.codec, "zstd");
    EXPECT_EQ(medium_back.codec, "zstd");
    EXPECT_EQ(text_of(medium.bytes.bytes()), text_of(medium_back.bytes.bytes()));
    EXPECT_EQ(packed.raw_bytes, packed_back.raw_bytes);
  }
}

TEST_F(Vault, TellsNothingByItsNamesAndHoldsNothingInPlain) {
  make_store();
  exported();
  for (const std::string& name : names()) {
    const std::string bytes = content(places_.vault / name);
    // Words of three letters would stand in random bytes now and then.
    for (const char* word : {"number", "driver", "Vision", "image"})
      EXPECT_EQ(bytes.find(word), std::string::npos) << word << " in " << name;
    EXPECT_TRUE(name == "engram.vault" || name.size() == 32) << name;
  }
  EXPECT_EQ(names().size(), 10U);
}

TEST_F(Vault, AddsOnlyWhatIsNew) {
  make_store();
  exported();
  const auto before = names();
  const auto old_keys = keys();
  const auto again = exported();
  EXPECT_EQ(again.unchanged, 9U);
  EXPECT_EQ(again.added + again.replaced + again.bytes, 0U);
  EXPECT_EQ(names(), before);
  {
    const auto writer = *ltm::StoreWriter::open(store_, {});
    const Time late = time_at(kFirstDay + kDays - 1, kPerDay) - std::chrono::minutes(5);
    ASSERT_OK(writer->append({ltm::pack_snapshot(snapshot(arm(), late, 7))}, nullptr));
  }
  const auto third = exported();
  EXPECT_EQ(third.replaced, 1U);
  EXPECT_EQ(third.snapshots, static_cast<uint64_t>(kPerDay + 1));
  EXPECT_EQ(third.unchanged, 8U);
  // The day that changed has another file and another key, and nothing of the old ones is left.
  const Day last = kFirstDay + kDays - 1;
  const VaultDay old_day = *old_keys.find(arm(), last), new_day = *keys().find(arm(), last);
  EXPECT_NE(old_day.file, new_day.file);
  EXPECT_EQ(content(places_.keys).find(text_of(old_day.key.bytes())), std::string::npos);
  EXPECT_NE(content(places_.keys).find(text_of(new_day.key.bytes())), std::string::npos);
  EXPECT_FALSE(names().contains(to_text(old_day.file)));
  EXPECT_EQ(names().size(), before.size());
  imported(scratch_ / "back");
  EXPECT_EQ(answers(store_), answers(scratch_ / "back"));
}

TEST_F(Vault, KnowsDaysAgainAfterSealingAndCompaction) {
  make_store();
  exported();
  const auto before = names();
  { ASSERT_OK((*ltm::StoreWriter::open(store_, {}))->seal()); }
  ASSERT_OK(ltm::compact(store_, {}));
  const auto again = exported();
  EXPECT_EQ(again.unchanged, 9U);
  EXPECT_EQ(again.added + again.replaced, 0U);
  EXPECT_EQ(names(), before);
}

TEST_F(Vault, TellsWhatTheStoreForgotSince) {
  make_store();
  { ASSERT_OK((*ltm::StoreWriter::open(store_, {}))->seal()); }
  EXPECT_EQ(exported().vault_alone, 0U);
  TimeSet whole, half;
  for (int64_t i = 0; i < kPerDay; ++i) {
    whole.insert(time_at(kFirstDay, i));
    if (i < kPerDay / 2) half.insert(time_at(kFirstDay + 1, i));
  }
  const VaultDay old = *keys().find(arm(), kFirstDay + 1);
  ASSERT_OK(ltm::forget_snapshots(store_, {{camera(), whole}, {arm(), half}}));
  const auto out = exported();
  EXPECT_EQ(out.vault_alone, 1U);
  // What is left of a day takes its place, and its old key goes.
  EXPECT_EQ(out.replaced, 1U);
  EXPECT_EQ(out.snapshots, static_cast<uint64_t>(kPerDay / 2));
  EXPECT_EQ(content(places_.keys).find(text_of(old.key.bytes())), std::string::npos);
  EXPECT_EQ(exported("Vision @ latest").vault_alone, 0U);
}

TEST_F(Vault, TakesWholeDaysOfWhichAQuerySelectsAnything) {
  make_store();
  const std::string time = to_string(time_at(kFirstDay + 1, 3));
  const auto out = exported("Vision @ " + time);
  EXPECT_EQ(out.added, 1U);
  EXPECT_EQ(out.snapshots, static_cast<uint64_t>(kPerDay));
  EXPECT_EQ(exported("Vision @ latest").added, 1U);
  EXPECT_EQ(exported().added, 7U);
}

TEST_F(Vault, WritesAgainWhatSomebodyRemoved) {
  make_store();
  exported();
  std::filesystem::remove(file_of(arm(), kFirstDay));
  EXPECT_FALSE(checked().is_whole());
  EXPECT_EQ(exported().replaced, 1U);
  EXPECT_TRUE(checked().is_whole());
}

TEST_F(Vault, GoesOnWithAnImportThatWasStopped) {
  make_store();
  exported();
  const auto back = scratch_ / "back";
  // A part of it is there, as after a stop.
  {
    VaultPlaces part{scratch_ / "part", scratch_ / "part.keys"};
    std::swap(part, places_);
    exported("Body");
    exported("Vision @ latest");
    imported(back);
    std::swap(part, places_);
  }
  const auto in = imported(back);
  EXPECT_EQ(in.already_there, 2U * kPerDay);
  EXPECT_EQ(in.snapshots, 3U * kDays * kPerDay - 2U * kPerDay);
  EXPECT_EQ(answers(store_), answers(back));
  EXPECT_EQ(imported(back).already_there, 3U * kDays * kPerDay);
}

TEST_F(Vault, LeavesWhatTheStoreHasAlready) {
  make_store();
  exported();
  const auto back = scratch_ / "back";
  ASSERT_OK(ltm::create_store(back));
  const auto other = snapshot(arm(), time_at(kFirstDay, 0), 999);
  {
    const auto writer = *ltm::StoreWriter::open(back, {});
    ASSERT_OK(writer->append({ltm::pack_snapshot(other)}, nullptr));
  }
  EXPECT_EQ(imported(back).already_there, 1U);
  const auto answer = answers(back, "Body");
  const auto found = answers(back, "Body @ " + to_string(other.time));
  EXPECT_EQ(found.find_snapshot(other.id())->instances[0].data, other.instances[0].data);
}

TEST_F(Vault, ARefusedImportDeclaresNothing) {
  make_store();
  const auto cage = *ltm::MemoryId::from_names({"Zoo", "Ape", "cage"});
  ASSERT_OK((*ltm::StoreWriter::open(store_, {}))->declare(cage, arm_type()));
  exported();
  const auto back = scratch_ / "\x1b[31mback";
  ASSERT_OK(ltm::create_store(back));
  const auto other = idf::Type::object("Cage", {{"doors", idf::Type::string()}});
  ASSERT_OK((*ltm::StoreWriter::open(back, {}))->declare(cage, other));
  EXPECT_FAILS(import_from_vault(places_, back, {}, {}), StatusCode::kFailedPrecondition,
               "\\x1b[31mback': segment 'Zoo/Ape/cage' has another type");
  EXPECT_EQ(ltm::read_manifest(back)->types.all().size(), 1U);
  EXPECT_EQ(ltm::read_manifest(back)->types.find(arm().parent()), nullptr);
}

TEST_F(Vault, StopsAtOnceAndLeavesNothingUnfinished) {
  make_store();
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(try_export("@ all", stop.get_token()), StatusCode::kCancelled, "stopped");
  EXPECT_EQ(names(), std::set<std::string>{"engram.vault"});
  EXPECT_EQ(exported().added, 9U);
  EXPECT_FAILS(check_vault(places_, {}, stop.get_token()), StatusCode::kCancelled, "stopped");
  const auto in = import_from_vault(places_, scratch_ / "back", {}, stop.get_token());
  ASSERT_OK(in);
  EXPECT_TRUE(in->is_cancelled);
}

TEST_F(Vault, AStoppedImportReportsWhatCameIn) {
  make_store();
  exported();
  const auto back = scratch_ / "back";
  std::stop_source stop;
  const ProgressSink progress = [&stop](const Progress& told) {
    if (told.done >= 40) stop.request_stop();
  };
  const auto in = import_from_vault(places_, back, progress, stop.get_token());
  ASSERT_OK(in);
  EXPECT_TRUE(in->is_cancelled);
  EXPECT_GE(in->snapshots, 40U);
  EXPECT_LT(in->snapshots, 50U);
  uint64_t found = 0;
  const auto reader = *ltm::StoreReader::open(back);
  for (const auto& entity : reader->entities()) found += (*reader->index(entity))->size();
  EXPECT_EQ(found, in->snapshots);
  const auto rest = imported(back);
  EXPECT_EQ(rest.already_there, found);
  EXPECT_EQ(answers(store_), answers(back));
}

TEST_F(Vault, ProgressNamesEntitiesAsATerminalMayShowThem) {
  make_store();
  std::string told;
  const ProgressSink progress = [&told](const Progress& step) { told += step.detail; };
  const auto expect_escaped = [&told] {
    EXPECT_NE(told.find("2019-04-14 Body/Arm/left/arm"), std::string::npos) << told;
    EXPECT_NE(told.find("\\x1b[31m\\n"), std::string::npos) << told;
    EXPECT_EQ(told.find_first_of("\x1b\n"), std::string::npos) << told;
    told.clear();
  };
  ltm::Recall recall(*ltm::StoreReader::open(store_), loader_);
  EXPECT_OK(export_to_vault(recall, *ltm::Query::parse("@ all"), places_, {}, progress, {}));
  expect_escaped();
  EXPECT_OK(check_vault(places_, progress, {}));
  expect_escaped();
  EXPECT_OK(import_from_vault(places_, scratch_ / "back", progress, {}));
  expect_escaped();
}

TEST_F(Vault, IsOfOneStore) {
  make_store();
  exported();
  const auto first = store_;
  store_ = scratch_ / "other";
  make_store();
  EXPECT_FAILS(try_export(), StatusCode::kFailedPrecondition, "--force");
  options_.is_dry = true;
  EXPECT_FAILS(try_export(), StatusCode::kFailedPrecondition, "--force");
  options_.is_dry = false;
  options_.takes_other_store = true;
  EXPECT_OK(try_export());
}

TEST_F(Vault, LeavesOutADayThatTheStoreCannotRead) {
  make_store();
  const std::string file = store_ / ltm::read_manifest(store_)->segments[0].file;
  std::string bytes = content(file);
  const auto at = bytes.find(text_of(image_in_store().bytes()));
  ASSERT_NE(at, std::string::npos);
  bytes[at] ^= 1;
  overwrite(file, bytes);
  const auto out = exported();
  ASSERT_EQ(out.unread.size(), 1U);
  EXPECT_EQ(out.unread[0].entity, camera());
  EXPECT_EQ(out.unread[0].day, kFirstDay);
  EXPECT_EQ(out.added, 8U);
  EXPECT_TRUE(checked().is_whole());
  EXPECT_EQ(names().size(), 1 + out.added);
}

TEST_F(Vault, DryRunChangesNothing) {
  make_store();
  options_.is_dry = true;
  const auto out = exported();
  EXPECT_EQ(out.added, 9U);
  EXPECT_EQ(out.snapshots, 3U * kDays * kPerDay);
  EXPECT_FALSE(std::filesystem::exists(places_.vault));
  EXPECT_FALSE(std::filesystem::exists(places_.keys));
  options_.is_dry = false;
  exported("Body @ all");
  const auto before = names();
  options_.is_dry = true;
  EXPECT_EQ(exported().added, 6U);
  EXPECT_EQ(names(), before);
  places_.keys = scratch_ / "missing.keys";
  EXPECT_FAILS(try_export(), StatusCode::kNotFound, "missing.keys");
}

TEST_F(Vault, DryRunTellsWhatAnExportDoes) {
  make_store();
  exported();
  std::filesystem::remove(file_of(arm(), kFirstDay));
  {
    auto folder = VaultFolder::open_keys(places_);
    ASSERT_OK(folder);
    ASSERT_OK(folder->destroy({{odd(), kFirstDay}}, system_now()));
  }
  for (const bool is_dry : {true, false}) {
    options_.is_dry = is_dry;
    const auto out = exported();
    EXPECT_EQ(out.added, 0U);
    EXPECT_EQ(out.replaced, 1U) << "a file that somebody removed";
    EXPECT_EQ(out.unchanged, 7U);
    EXPECT_EQ(out.destroyed, 1U);
    EXPECT_EQ(out.snapshots, static_cast<uint64_t>(kPerDay));
  }
}

// Destroyed keys.

TEST_F(Vault, ADestroyedKeyLeavesNothingOfItsDay) {
  make_store();
  exported();
  const auto before = keys();
  const VaultDay gone = *before.find(camera(), kFirstDay);
  const std::string sealed = content(file_of(camera(), kFirstDay)).substr(kSealedHeaderBytes, 64);
  const int old_inode = ::open(places_.keys.c_str(), O_RDONLY);
  {
    auto folder = VaultFolder::open_keys(places_);
    ASSERT_OK(folder);
    ASSERT_OK(folder->destroy({{camera(), kFirstDay}}, system_now()));
  }
  // Neither in the key file, nor in its old blocks, nor anywhere beside it.
  const std::string key = text_of(gone.key.bytes());
  std::string old(1 << 20, '\0');
  old.resize(
      static_cast<size_t>(std::max<ssize_t>(::pread(old_inode, old.data(), old.size(), 0), 0)));
  ::close(old_inode);
  EXPECT_GT(old.size(), 1000U);
  EXPECT_EQ(old.find(key), std::string::npos);
  EXPECT_EQ(old.find("ENGRAMVK"), std::string::npos) << "the old bytes were overwritten";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scratch_.path()))
    if (entry.is_regular_file()) {
      const std::string bytes = content(entry.path());
      EXPECT_EQ(bytes.find(key), std::string::npos) << entry.path();
      EXPECT_EQ(bytes.find(sealed), std::string::npos) << entry.path();
    }
  EXPECT_FALSE(names().contains(to_text(gone.file)));
  const auto check = checked();
  EXPECT_TRUE(check.is_whole());
  EXPECT_EQ(check.destroyed, 1U);
  // All other days are as they were, and it is told that this one is gone.
  const auto back = scratch_ / "back";
  const auto in = imported(back);
  EXPECT_EQ(in.destroyed, 1U);
  EXPECT_TRUE(in.damaged.empty());
  EXPECT_EQ(in.snapshots, 3U * kDays * kPerDay - kPerDay);
  EXPECT_EQ(answers(store_, "Body @ all"), answers(back, "Body @ all"));
  const std::string rest = "Vision @ " + to_string(day_begin(kFirstDay + 1)) + ".." +
                           to_string(day_end(kFirstDay + kDays));
  EXPECT_EQ(answers(store_, rest), answers(back, rest));
  // Nothing forgotten comes back.
  const auto again = exported();
  EXPECT_EQ(again.destroyed, 1U);
  EXPECT_EQ(again.added, 0U);
}

TEST_F(Vault, KeysAreDestroyedWhereTheVaultIsOutOfReach) {
  make_store();
  exported();
  const auto elsewhere = scratch_ / "unmounted";
  std::filesystem::rename(places_.vault, elsewhere);
  {
    auto folder = VaultFolder::open_keys(places_);
    ASSERT_OK(folder);
    EXPECT_FALSE(folder->is_within_reach());
    ASSERT_OK(folder->destroy({{arm(), kFirstDay}, {odd(), kFirstDay}}, system_now()));
  }
  EXPECT_FAILS(try_export(), StatusCode::kFailedPrecondition, "mounted");
  EXPECT_FALSE(std::filesystem::exists(places_.vault)) << "no second vault was begun";
  std::filesystem::rename(elsewhere, places_.vault);
  EXPECT_EQ(checked().remains, 2U);
  exported();
  EXPECT_EQ(checked().remains, 0U);
  EXPECT_EQ(names().size(), 8U);
}

TEST_F(Vault, WhoHoldsTheVaultCannotStopTheDestructionOfKeys) {
  make_store();
  exported();
  namespace fs = std::filesystem;
  const auto mark = places_.vault / "engram.vault", real = scratch_ / "real";
  const auto gone = [this] { return to_text(keys().find(camera(), kFirstDay)->file); };
  const std::vector<std::pair<bool, std::function<void()>>> tricks{
      {true, [&] { overwrite(mark, "garbage"); }},
      {true, [&] { fs::resize_file(mark, uint64_t{1} << 20); }},
      {false,
       [&] {
         fs::remove(mark);
         fs::create_directory(mark);
       }},
      {false,
       [&] {
         fs::remove(places_.vault / gone());
         fs::create_directories(places_.vault / gone() / "full");
       }},
      {false,
       [&] {
         fs::remove_all(places_.vault);
         fs::create_symlink(places_.vault, places_.vault);
       }},
      {false,
       [&] {
         fs::remove_all(places_.vault);
         fs::create_symlink(scratch_.path(), places_.vault);
       }},
      {false, [&] {
         fs::remove_all(places_.vault);
         overwrite_file(places_.vault, as_bytes("a file"));
       }}};
  fs::copy(places_.vault, real);
  fs::copy(places_.keys, scratch_ / "kept.keys");
  for (size_t i = 0; i < tricks.size(); ++i) {
    SCOPED_TRACE(i);
    fs::remove_all(places_.vault);
    fs::copy(real, places_.vault);
    fs::copy_file(scratch_ / "kept.keys", places_.keys, fs::copy_options::overwrite_existing);
    const std::string key = text_of(keys().find(camera(), kFirstDay)->key.bytes());
    const std::string file = gone();
    tricks[i].second();
    auto folder = VaultFolder::open_keys(places_);
    ASSERT_OK(folder);
    ASSERT_OK(folder->destroy({{camera(), kFirstDay}}, system_now()));
    EXPECT_EQ(folder->is_within_reach(), tricks[i].first);
    EXPECT_EQ(content(places_.keys).find(key), std::string::npos);
    EXPECT_TRUE(keys().is_destroyed(camera(), kFirstDay));
    if (tricks[i].first) {
      EXPECT_FALSE(names().contains(file));
    }
  }
}

TEST_F(Vault, FindsTheDaysThatTextsName) {
  make_store();
  exported();
  const auto found = [this](const std::string& text) { return find_vault_days(keys(), {text}); };
  using Days = std::vector<EntityDay>;
  const auto day = [](int i) { return day_text(kFirstDay + i); };
  EXPECT_EQ(*found("Vision/RGB"),
            (Days{{camera(), kFirstDay}, {camera(), kFirstDay + 1}, {camera(), kFirstDay + 2}}));
  EXPECT_EQ(*found("Body @ " + day(1)), (Days{{arm(), kFirstDay + 1}}));
  EXPECT_EQ(*found("Body @ " + day(0) + ".." + day(1)),
            (Days{{arm(), kFirstDay}, {arm(), kFirstDay + 1}}));
  EXPECT_EQ(*found("Body @ until:" + to_string(time_at(kFirstDay, 1))), (Days{{arm(), kFirstDay}}));
  EXPECT_EQ(*found(arm().at(time_at(kFirstDay + 2, 5)).to_string()),
            (Days{{arm(), kFirstDay + 2}}));
  EXPECT_EQ(found(".* @ all")->size(), 9U);
  EXPECT_EQ(found(odd().to_string())->size(), 3U) << "though its name has an @";
  EXPECT_FAILS(found("Body @ latest"), StatusCode::kInvalidArgument, "needs a day");
  EXPECT_FAILS(found("Body @ before:" + to_string(time_at(kFirstDay, 1))),
               StatusCode::kInvalidArgument, "needs a day");
  EXPECT_FAILS(found("Nothing"), StatusCode::kNotFound, "names no day");
  EXPECT_FAILS(found(""), StatusCode::kNotFound, "names no day");
  EXPECT_FAILS(found("Body @ " + day(2) + ".." + day(1)), StatusCode::kInvalidArgument, "ends");
  EXPECT_FAILS(find_vault_days(keys(), {"Body", "Nothing"}), StatusCode::kNotFound, "Nothing");
}

TEST_F(Vault, OfFormat1IsReadForEver) {
  // Made by this fixture, with the camera's first day destroyed.
  const std::filesystem::path golden =
      std::filesystem::path(ENGRAM_SOURCE_DIR) / "tests/golden/vault/format_1";
  std::filesystem::copy(golden / "robot.vault", places_.vault,
                        std::filesystem::copy_options::recursive);
  std::filesystem::copy(golden / "robot.keys", places_.keys);
  std::filesystem::permissions(
      places_.keys, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  EXPECT_TRUE(checked().is_whole());
  EXPECT_EQ(checked().snapshots, 8U * kPerDay);
  const auto in = imported(scratch_ / "back");
  EXPECT_EQ(in.destroyed, 1U);
  make_store();
  for (const std::string query : {"Body @ all", "Vision @ latest:24"})
    EXPECT_EQ(answers(store_, query), answers(scratch_ / "back", query)) << query;
  EXPECT_EQ(answers(scratch_ / "back").find_snapshot(camera().at(time_at(kFirstDay, 0))), nullptr);
}

}  // namespace
}  // namespace engram::datasets::vault
