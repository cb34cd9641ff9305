#include "cabinet/calibration.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <string>

using namespace cabinet;

namespace {

std::string rod_json(const std::string& slide, const std::string& angle) {
  return R"({"slide_m_per_count": )" + slide + R"(, "angle_rad_per_count": )" + angle + "}";
}

const std::string kGoodRod = rod_json("[0.000125, 0]", "[0, 0.015625]");

// Eight valid rods except the sixth.
std::string file_json(const std::string& sixth_rod = kGoodRod, int rods = 8) {
  std::string text = R"({"version": 1, "rods": [)";
  for (int i = 0; i < rods; ++i) text += (i > 0 ? "," : "") + (i == 5 ? sixth_rod : kGoodRod);
  return text + "]}";
}

std::string complaint(const std::string& json) {
  const auto calibration = parse_calibration(json, "c.json");
  return calibration ? std::string() : calibration.error();
}

struct Folder {
  std::string path = testing::TempDir() + "cabinet_calibration_" + std::to_string(getpid());
  Folder() { mkdir(path.c_str(), 0700); }
  ~Folder() {
    unlink((path + "/c.json").c_str());
    rmdir(path.c_str());
  }
  std::string file() const { return path + "/c.json"; }
};

TEST(Calibration, NominalIsEightCountsAMillimetreOnA16MillimetreRod) {
  const Calibration calibration = nominal_calibration();
  for (const RodCalibration& rod : calibration.rods) {
    EXPECT_DOUBLE_EQ(320 * rod.m[0][0], 0.04);                 // 40 mm
    EXPECT_NEAR(8 * 4 * M_PI * rod.m[1][1], M_PI / 2, 1e-12);  // a quarter of the circumference
    EXPECT_EQ(rod.m[0][1], 0);
    EXPECT_EQ(rod.m[1][0], 0);
  }
}

TEST(Calibration, SavedAndLoadedIsTheSameToTheBit) {
  const Folder folder;
  Calibration calibration = nominal_calibration(39.37, 0.0163);
  calibration.rods[3].m[0][1] = -1.0 / 3 * 1e-6;
  calibration.rods[3].m[1][0] = 0.1 * calibration.rods[3].m[1][1];
  calibration.rods[3].slide_gain[1] = -0.03;
  calibration.rods[3].spin_gain[0] = 0.05;
  calibration.rods[3].dead_band = 12.5;
  calibration.serial = "SF-0042";
  calibration.made = "2026-11-22T23:59:59Z";
  const auto saved = save_calibration(calibration, folder.file());
  ASSERT_TRUE(saved.has_value()) << saved.error();
  const auto loaded = load_calibration(folder.file());
  ASSERT_TRUE(loaded.has_value()) << loaded.error();
  EXPECT_EQ(loaded->rods[3].slide_gain[1], -0.03);
  EXPECT_EQ(loaded->rods[3].spin_gain[0], 0.05);
  EXPECT_EQ(loaded->rods[3].dead_band, 12.5);
  EXPECT_EQ(loaded->serial, "SF-0042");
  EXPECT_EQ(loaded->made, "2026-11-22T23:59:59Z");
  EXPECT_EQ(loaded->rods[4].slide_gain[1], 0);
  for (int rod = 0; rod < kRods; ++rod) {
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        EXPECT_EQ(loaded->rods[rod].m[i][j], calibration.rods[rod].m[i][j]);
      }
    }
  }
}

TEST(Calibration, TheExampleFileIsTheNominalOne) {
  const auto example = load_calibration(CABINET_DIR "/calibration.example.json");
  ASSERT_TRUE(example.has_value()) << example.error();
  EXPECT_EQ(example->rods[0].m[0][0], nominal_calibration().rods[0].m[0][0]);
  EXPECT_EQ(example->rods[7].m[1][1], nominal_calibration().rods[7].m[1][1]);
}

TEST(Calibration, AMirroredSensorIsFine) {
  EXPECT_EQ(complaint(file_json(rod_json("[-0.000125, 0]", "[0, -0.015625]"))), "");
  EXPECT_EQ(complaint(file_json(rod_json("[0, 0.000125]", "[0.015625, 0]"))), "");
}

TEST(Calibration, TheCoarsestAndTheFinestSensorAreFine) {
  EXPECT_EQ(complaint(file_json(rod_json("[0.001, 0]", "[0, 0.125]"))), "");
  EXPECT_EQ(complaint(file_json(rod_json("[2.1e-6, 0]", "[0, 2.6e-4]"))), "");
}

// Version 2 with additional fields of the sixth rod.
std::string corrected(const std::string& more) {
  std::string text = file_json(kGoodRod.substr(0, kGoodRod.size() - 1) + ", " + more + "}");
  return text.replace(text.find("\"version\": 1"), 12, "\"version\": 2");
}

TEST(Calibration, AFileOfBeforeIsRead) {
  const auto before = parse_calibration(file_json(), "c.json");
  ASSERT_TRUE(before.has_value()) << before.error();
  EXPECT_EQ(before->rods[5].slide_gain[0], 0);
  EXPECT_EQ(before->rods[5].dead_band, 0);
  EXPECT_EQ(complaint(corrected(R"("slide_gain": [0.03, 0.01])")), "");  // the others are zero
}

TEST(Calibration, AnIndexMarkIsKeptAndMayBeLeftOut) {
  const auto marked = parse_calibration(
      corrected(R"("index_angle_rad": -2.5, "index_width_rad": 0.4, "index_lag_rad": 0.01)"), "c");
  ASSERT_TRUE(marked) << marked.error();
  ASSERT_TRUE(marked->rods[5].index);
  EXPECT_FALSE(marked->rods[4].index);
  const Folder folder;
  ASSERT_TRUE(save_calibration(*marked, folder.file()));
  const auto read = load_calibration(folder.file());
  ASSERT_TRUE(read && read->rods[5].index) << read.error();
  EXPECT_EQ(read->rods[5].index->angle, -2.5);
  EXPECT_EQ(read->rods[5].index->width, 0.4);
  EXPECT_EQ(read->rods[5].index->lag, 0.01);
  EXPECT_FALSE(read->rods[4].index);
}

struct BadFile {
  const char* what;
  std::string json;
  const char* sentence;  // part of it
};

class BadCalibration : public testing::TestWithParam<BadFile> {};

TEST_P(BadCalibration, IsRefusedWithOneSentenceThatSaysWhatToDo) {
  const std::string sentence = complaint(GetParam().json);
  EXPECT_NE(sentence.find(GetParam().sentence), std::string::npos) << sentence;
  EXPECT_EQ(sentence.rfind("Calibration c.json ", 0), 0u) << sentence;
  EXPECT_EQ(sentence.back(), '.');
  EXPECT_EQ(sentence.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Of, BadCalibration,
    testing::Values(
        BadFile{"Empty", "", "is empty; calibrate again"},
        BadFile{"Blank", " \n\t ", "is empty; calibrate again"},
        BadFile{"Text", "hello", "is not JSON at byte 1"},
        BadFile{"Truncated", file_json().substr(0, 200), "is not JSON at byte 201"},
        BadFile{"Nested", std::string(60'000, '['), "is not JSON"},
        BadFile{"Long", std::string(70'000, ' ') + "{}", "is longer than 64 KiB"},
        BadFile{"Array", "[1]", "is not a calibration"},
        BadFile{"NoVersion", R"({"rods": []})", "has no \"version\": 3"},
        BadFile{"LaterVersion", R"({"version": 4, "rods": []})", "is of version 4"},
        BadFile{"VersionIsWord", R"({"version": "3", "rods": []})", "has no \"version\": 3"},
        BadFile{"SerialIsNumber", R"({"version": 3, "serial": 7, "rods": []})", "\"serial\""},
        BadFile{"LongDate",
                R"({"version": 3, "made": ")" + std::string(65, '2') + R"(", "rods": []})",
                "\"made\""},
        BadFile{"GainIsOneNumber", corrected(R"("slide_gain": [0.03])"),
                "(rod 6) has no \"slide_gain\" of two numbers"},
        BadFile{"GainIsTooLarge", corrected(R"("spin_gain": [0.4, 0.4])"),
                "(rod 6) has a gain above 0.5"},
        BadFile{"DeadBandIsWord", corrected(R"("dead_band_counts_per_s": "no")"),
                "(rod 6) has a \"dead_band_counts_per_s\" that is no number"},
        BadFile{"DeadBandIsNegative", corrected(R"("dead_band_counts_per_s": -1)"),
                "(rod 6) has a dead band out of 0 to 4000"},
        BadFile{"MarkWithoutWidth", corrected(R"("index_angle_rad": 1)"),
                "(rod 6) has no number \"index_width_rad\""},
        BadFile{"MarkIsWord", corrected(R"("index_angle_rad": "1", "index_width_rad": 0.4)"),
                "(rod 6) has no number \"index_angle_rad\""},
        BadFile{"MarkIsTooWide", corrected(R"("index_angle_rad": 1, "index_width_rad": 3)"),
                "(rod 6) has an impossible index mark"},
        BadFile{"MarkLagsTooFar",
                corrected(R"("index_angle_rad": 1, "index_width_rad": 0.4, "index_lag_rad": -0.5)"),
                "(rod 6) has an impossible index mark"},
        BadFile{"NoRods", R"({"version": 1})", "has 0 rods instead of 8"},
        BadFile{"SevenRods", file_json(kGoodRod, 7), "has 7 rods instead of 8"},
        BadFile{"NineRods", file_json(kGoodRod, 9), "has 9 rods instead of 8"},
        BadFile{"RodIsNumber", file_json("3"), "(rod 6) is not an object"},
        BadFile{"NoAngle", file_json(R"({"slide_m_per_count": [1, 2]})"),
                "(rod 6) has no \"angle_rad_per_count\" of two numbers"},
        BadFile{"ThreeNumbers", file_json(rod_json("[1, 2, 3]", "[0, 1]")),
                "(rod 6) has no \"slide_m_per_count\" of two numbers"},
        BadFile{"Word", file_json(rod_json("[\"a\", 0]", "[0, 1]")),
                "(rod 6) has no \"slide_m_per_count\" of two numbers"},
        BadFile{"NotFinite", file_json(rod_json("[NaN, 0]", "[0, 0.015]")), "is not JSON"},
        BadFile{"Overflow", file_json(rod_json("[1e999, 0]", "[0, 0.015]")), "out of range"},
        BadFile{"Singular", file_json(rod_json("[0.000125, 0.000125]", "[0.0156, 0.0156]")),
                "(rod 6) is singular"},
        BadFile{"AlmostSingular", file_json(rod_json("[0.000125, 0]", "[0.0156, 0.0001]")),
                "(rod 6) is singular"},
        BadFile{"Zero", file_json(rod_json("[0, 0]", "[0, 0]")), "(rod 6) is singular"},
        BadFile{"MetresForMillimetres", file_json(rod_json("[0.125, 0]", "[0, 0.0156]")),
                "(rod 6) has an impossible scale: 125 mm along the rod and 0.125 mm"},
        BadFile{"ThousandTimesTheExample", file_json(rod_json("[0.1, 0]", "[0, 12.5]")),
                "where 0.00053 mm to 4 mm are possible; write metres"},
        BadFile{"TenTimesTheCoarsestSensor", file_json(rod_json("[0.01, 0]", "[0, 1.25]")),
                "(rod 6) has an impossible scale"},
        BadFile{"TenTimesTheFinestSensor", file_json(rod_json("[2.1e-7, 0]", "[0, 2.6e-5]")),
                "(rod 6) has an impossible scale"},
        BadFile{"Tiny", file_json(rod_json("[0.000125, 0]", "[0, 1e-9]")),
                "(rod 6) has an impossible scale"}),
    [](const auto& test) { return test.param.what; });

TEST(CalibrationFile, MissingFileAndFolderAreSentences) {
  const auto missing = load_calibration("/nowhere/c.json");
  ASSERT_FALSE(missing.has_value());
  EXPECT_NE(missing.error().find("Calibration /nowhere/c.json cannot be opened (No such file or "
                                 "directory); give an existing file"),
            std::string::npos)
      << missing.error();
  const auto folder = load_calibration("/tmp");
  ASSERT_FALSE(folder.has_value());
  EXPECT_NE(folder.error().find("is not a file"), std::string::npos) << folder.error();
}

TEST(CalibrationFile, AFailedSaveSaysSoAndLeavesTheOldFile) {
  const auto nowhere = save_calibration(nominal_calibration(), "/nowhere/c.json");
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_NE(nowhere.error().find("cannot be written"), std::string::npos) << nowhere.error();

  const Folder folder;
  ASSERT_TRUE(save_calibration(nominal_calibration(), folder.file()).has_value());
  for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity(), 0.0}) {
    Calibration broken = nominal_calibration();
    broken.rods[2].m[0][0] = wrong;
    const auto refused = save_calibration(broken, folder.file());
    ASSERT_FALSE(refused.has_value());
    EXPECT_NE(refused.error().find("(rod 3)"), std::string::npos) << refused.error();
  }
  EXPECT_TRUE(load_calibration(folder.file()).has_value());
  EXPECT_NE(access((folder.file() + ".new").c_str(), F_OK), 0);
}

}  // namespace
