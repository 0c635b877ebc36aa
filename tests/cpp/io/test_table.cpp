// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "condyle/io/table.hpp"
#include "io/scratch_file.hpp"

using condyle::io::read_table;
using condyle::io::Table;
using condyle::io::to_csv;
using condyle::io::write_whole;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

std::string refusal(const ScratchFile& file) {
  return message_of<std::invalid_argument>([&] { read_table(file.path()); });
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("comments, blanks, spaces and a byte-order mark are read past [property]") {
  const ScratchFile file("read.csv",
                         "\xEF\xBB\xBF# first\r\n\r\n#second\r\n a , b\t,c\r\n"
                         "1, -2.5e-3 ,+4\r\n\r\nnan,inf,-inf\r\n");
  const Table table = read_table(file.path());
  CHECK(table.source == file.name());
  CHECK(table.comments == std::vector<std::string>{"first", "second"});
  CHECK(table.names == std::vector<std::string>{"a", "b", "c"});
  CHECK(table.row_count() == 2);
  CHECK(table.lines == std::vector<std::size_t>{5, 7});
  CHECK(table.column("a")[0] == 1.0);
  CHECK(table.column("b")[0] == -2.5e-3);
  CHECK(table.column("c")[0] == 4.0);
  CHECK(std::isnan(table.column("a")[1]));
  CHECK(table.column("c")[1] == -std::numeric_limits<double>::infinity());
}

TEST_CASE("a last line without its end counts [property]") {
  const ScratchFile file("end.csv", "a\n1\n2");
  CHECK(read_table(file.path()).column("a") == std::vector<double>{1.0, 2.0});
}

TEST_CASE("what is written reads back to the same doubles [property]") {
  const std::vector<double> hard{
      0.1,  -1.0 / 3.0, 5e-324, std::numeric_limits<double>::max(), -2.2250738585072014e-308,
      1e22, -0.0};
  Table table;
  table.comments = {"units: m"};
  table.add_column("x", hard);
  table.add_column("y", {7, 6, 5, 4, 3, 2, 1});
  const ScratchFile file("round_trip.csv");
  write_whole(file.path(), to_csv(table));
  const Table back = read_table(file.path());
  CHECK(back.comments == table.comments);
  CHECK(back.names == table.names);
  for (std::size_t i = 0; i < hard.size(); ++i) {
    CHECK(back.column("x")[i] == hard[i]);
    CHECK(std::signbit(back.column("x")[i]) == std::signbit(hard[i]));
  }
}

TEST_CASE("words follow the numbers [property]") {
  Table table;
  table.comments = {"units: m"};
  table.add_column("x", {0.5, -2});
  table.add_column("y", {1e-9, 40});
  table.text_columns = {{"status", {"ok", "too deep: medial"}}, {"side", {"left", ""}}};
  CHECK(to_csv(table) ==
        "# units: m\nx,y,status,side\n0.5,1e-09,ok,left\n-2,40,too deep: medial,\n");
}

TEST_CASE("a table that would not read back is not written [error]") {
  const auto refusal_of = [](const Table& table) {
    return message_of<std::invalid_argument>([&] { to_csv(table); });
  };
  Table table;
  table.add_column("x", {0.5, -2});
  table.add_column("y", {1});
  CHECK(refusal_of(table) == "table: column 'y' has 1 rows where the first has 2");
  table.columns[1].push_back(3);
  table.text_columns = {{"status", {"ok"}}};
  CHECK(refusal_of(table) == "table: column 'status' has 1 rows where the first has 2");
  for (const char* word : {"a,b", "a\nb", "a\rb", "a\"b"}) {
    table.text_columns = {{"status", {"ok", word}}};
    CHECK(refusal_of(table) == "table: column 'status': '" + std::string(word) +
                                   "' holds a comma, a quote or the end of a line");
  }
}

TEST_CASE("a missing column is named, with those present [error]") {
  const ScratchFile file("missing.csv", "x,y\n1,2\n");
  const Table table = read_table(file.path());
  CHECK(message_of<std::invalid_argument>([&] { table.column("theta_x"); }) ==
        file.name() + ": no column 'theta_x' (columns: x, y)");
}

TEST_CASE("what cannot be read is named by file, line and column [error]") {
  const ScratchFile absent("absent.csv");
  CHECK(refusal(absent) == absent.name() + ": cannot be opened for reading");
  const auto folder = std::filesystem::temp_directory_path();
  CHECK(message_of<std::invalid_argument>([&] { read_table(folder); }) ==
        folder.string() + ": cannot be opened for reading");

  const ScratchFile no_header("no_header.csv", "# a comment\n\n");
  CHECK(refusal(no_header) == no_header.name() + ": no header line");
  const ScratchFile no_rows("no_rows.csv", "x,y\n\n");
  CHECK(refusal(no_rows) == no_rows.name() + ": no rows below the header");
  const ScratchFile twice("twice.csv", "x,y,x\n1,2,3\n");
  CHECK(refusal(twice) == twice.name() + ": column 'x' appears twice");
  const ScratchFile nameless("nameless.csv", "x,,z\n1,2,3\n");
  CHECK(refusal(nameless) == nameless.name() + ": column 2 has no name");
  const ScratchFile ragged("ragged.csv", "# c\nx,y\n1,2\n3\n");
  CHECK(refusal(ragged) == ragged.name() + ", line 4: 1 fields where the header has 2");
  for (const char* word : {"1.5m", "", "0x10", "1 2", "--1"}) {
    const ScratchFile file("word.csv", "x,y\n1," + std::string(word) + "\n");
    CHECK(refusal(file) == file.name() + ", line 2, column 'y': '" + word + "' is not a number");
  }
}

TEST_CASE("a file is written whole, over what was there [property]") {
  const ScratchFile file("whole.txt", "an older and much longer text\n");
  write_whole(file.path(), "new\n");
  CHECK(text_of(file.path()) == "new\n");
  CHECK_FALSE(std::filesystem::exists(file.name() + ".partial"));
}

TEST_CASE("what cannot be written is named, and leaves nothing behind [error]") {
  const std::filesystem::path nowhere = "/nowhere/loads.csv";
  CHECK(message_of<std::runtime_error>([&] { write_whole(nowhere, "x\n"); }) ==
        "/nowhere/loads.csv: cannot be written");
  // A folder in the place of the file: the text is complete beside it, and only the rename fails.
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "condyle_io_folder";
  std::filesystem::create_directories(folder / "full");
  CHECK(message_of<std::runtime_error>([&] {
          write_whole(folder, "x\n");
        }).starts_with(folder.string() + ": cannot be written: "));
  CHECK_FALSE(std::filesystem::exists(folder.string() + ".partial"));
  std::filesystem::remove_all(folder);
}
