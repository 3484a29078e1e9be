// The reader of case files and the generators of random cases.
#include "cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

namespace carom_bench {
namespace {

const char kHeader[] =
    "id,kind,R,M,u_s1,u_s2,u_b,e_b,r1x,r1y,r1z,v1x,v1y,v1z,w1x,w1y,w1z,"
    "r2x,r2y,r2z,v2x,v2y,v2z,w2x,w2y,w2z\n";
const char kRow[] =
    "7,stun,0.03,0.2,0.21,0.22,0.05,0.9,1,2,3,4,5,6,7,8,9,1.06,2,3,nan,0,0,0,0,-inf\n";

std::vector<Case> read(const std::string& text) {
  std::istringstream in(text);
  return read_cases(in, "some.csv");
}

std::string complaint(const std::string& text) {
  try {
    read(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(ReadCases, ReadsEveryColumnByName) {
  const std::vector<Case> cases = read(std::string(kHeader) + kRow);
  ASSERT_EQ(cases.size(), 1U);
  EXPECT_EQ(cases[0].id, 7);
  EXPECT_EQ(cases[0].kind, "stun");
  EXPECT_EQ(cases[0].params.u_s2, 0.22);
  EXPECT_EQ(cases[0].ball1[8], 9);
  EXPECT_EQ(cases[0].ball2[0], 1.06);
  EXPECT_TRUE(std::isnan(cases[0].ball2[3]));
  EXPECT_TRUE(std::isinf(cases[0].ball2[8]));
}

TEST(ReadCases, NamesFileLineAndColumn) {
  std::string text = std::string(kHeader) + kRow;
  text.replace(text.find("0.05"), 4, "fast");
  const std::string message = complaint(text);
  RecordProperty("message", message);
  for (const char* part : {"some.csv", "2", "u_b"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(ReadCases, NamesAMissingColumn) {
  std::string text = std::string(kHeader) + kRow;
  text.replace(text.find("e_b"), 3, "eee");
  EXPECT_NE(complaint(text).find("e_b"), std::string::npos) << complaint(text);
}

TEST(ReadCases, ReadsTheReference) {
  const std::vector<Case> cases = read_cases(CAROM_REFERENCE "/inputs.csv");
  ASSERT_EQ(cases.size(), 950U);
  EXPECT_EQ(cases[0].kind, "rolling_vs_rest");
  EXPECT_THROW(read_cases(CAROM_REFERENCE "/none.csv"), std::runtime_error);
}

TEST(RandomCases, SameSeedSameNumbers) {
  const std::vector<Case> one = random_cases(3, 400), two = random_cases(3, 400);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(std::equal(one[i].ball1, one[i].ball1 + 9, two[i].ball1));
  }
  EXPECT_NE(random_cases(4, 1)[0].ball1[0], one[0].ball1[0]);
}

TEST(RandomCases, DealsOutEveryKind) {
  const std::vector<std::string> kinds = case_kinds();
  std::set<std::string> seen;
  for (const Case& one : random_cases(3, 2 * kinds.size())) seen.insert(one.kind);
  EXPECT_EQ(seen, std::set<std::string>(kinds.begin(), kinds.end()));
}

}  // namespace
}  // namespace carom_bench
