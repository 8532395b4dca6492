#include "core/printable.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

TEST(Printable, KeepsPrintableCharacters) {
  EXPECT_EQ(printable(""), "");
  EXPECT_EQ(printable("ULX3S FPGA 85K v3.0.8"), "ULX3S FPGA 85K v3.0.8");
  EXPECT_EQ(printable("Gr\u00f6\u00dfe \u20ac \U0001F600"), "Gr\u00f6\u00dfe \u20ac \U0001F600");
}

TEST(Printable, EscapesWhatATerminalWouldObey) {
  EXPECT_EQ(printable("\x1b[2Jevil\r\n\t\x07"), "\\x1b[2Jevil\\x0d\\x0a\\x09\\x07");
  EXPECT_EQ(printable("\x7f"), "\\x7f");
  EXPECT_EQ(printable("\u009b31m"), "\\xc2\\x9b31m") << "a control sequence in one character";
  EXPECT_EQ(printable("a\u202eb"), "a\\xe2\\x80\\xaeb") << "right to left";
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(Printable, EscapesBytesThatAreNotUtf8) {
  EXPECT_EQ(printable("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(printable("\xc3"), "\\xc3") << "cut off";
  EXPECT_EQ(printable("\xc3(\xa9"), "\\xc3(\\xa9");
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf") << "longer than needed";
  EXPECT_EQ(printable("\xe0\x80\xaf"), "\\xe0\\x80\\xaf") << "longer than needed";
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a pair of UTF-16";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
}

TEST(Printable, CutsLongText) {
  EXPECT_EQ(printable("12345678", 8), "12345678");
  EXPECT_EQ(printable("123456789", 8), "12345678...");
  EXPECT_EQ(printable("1234567\u00e4", 8), "1234567...") << "no half characters";
  EXPECT_EQ(printable("123456\x1b", 8), "123456...");
  EXPECT_EQ(printable(std::string(1000000, 'x')), std::string(80, 'x') + "...");
}

}  // namespace
}  // namespace fpga_stereo::test
