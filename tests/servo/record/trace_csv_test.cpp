// SPDX-License-Identifier: Apache-2.0
#include "servo/record/trace_csv.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/servo/support/shape_asset.hpp"

namespace trace_csv_test {

using namespace spm::servo;
using spm::test::TemporaryFolder;

TEST_CASE("A table has the contract's header, a line a row, and numbers that round-trip") {
  const TemporaryFolder folder;
  auto table = TraceCsv::create(folder.file("a.csv"));
  REQUIRE(table);
  TraceRow row;
  row.t = 0.1;
  row.position = {1.0 / 3, -1e-9, 123456.789};
  row.force = {0, -0.0, 2.0 / 7};
  row.depth = 1e-3 / 3;
  row.contact = true;
  table->append(row);
  REQUIRE(table->commit());

  std::ifstream file(folder.file("a.csv"));
  std::string line;
  std::getline(file, line);
  REQUIRE(line == "t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact");
  std::getline(file, line);
  REQUIRE(line.find("-0,") == std::string::npos);
  std::istringstream fields(line);
  std::vector<double> numbers;
  for (std::string field; std::getline(fields, field, ',');) numbers.push_back(std::stod(field));
  REQUIRE(numbers == std::vector<double>{0.1, 1.0 / 3, -1e-9, 123456.789, 0, 0, 2.0 / 7, 0, 0, 0,
                                         1e-3 / 3, 1});
  REQUIRE_FALSE(std::getline(file, line));
}

TEST_CASE("With a tool a table has further columns after the contract's") {
  const TemporaryFolder folder;
  auto table = TraceCsv::create(folder.file("a.csv"), true);
  REQUIRE(table);
  TraceRow row;
  row.torque = {0.1, 0, 0.2};
  row.orientation = Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5);
  row.tool = {{1, 2, 3}, Eigen::Quaterniond(0, 1, 0, 0)};
  row.patches = 4;
  row.level = 2;
  row.culled = 7;
  row.torque_capped = true;
  table->append(row);
  REQUIRE(table->commit());
  std::ifstream file(folder.file("a.csv"));
  std::string line;
  std::getline(file, line);
  CHECK(line ==
        "t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact,qw,qx,qy,qz,tool_x,tool_y,tool_z,tool_qw,tool_qx,"
        "tool_qy,tool_qz,patches,level,culled,force_capped,torque_capped,tool_capped");
  std::getline(file, line);
  CHECK(line == "0,0,0,0,0,0,0,0.1,0,0.2,0,0,0.5,-0.5,0.5,0.5,1,2,3,0,1,0,0,4,2,7,0,1,0");
}

TEST_CASE("A table that is not committed leaves nothing behind") {
  const TemporaryFolder folder;
  {
    auto table = TraceCsv::create(folder.file("a.csv"));
    REQUIRE(table);
    for (int i = 0; i < 10'000; ++i) table->append({});
  }
  REQUIRE(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("A table in a folder that does not exist is refused with exit code 2") {
  const TemporaryFolder folder;
  const auto table = TraceCsv::create(folder.file("none/a.csv"));
  REQUIRE_FALSE(table);
  REQUIRE(table.error().code == spm::ExitCode::file_or_device);
}

}  // namespace trace_csv_test
