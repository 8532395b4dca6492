#include "core/similar_names.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <utility>

namespace fpga_stereo {
namespace {

constexpr std::size_t kMaxDifference = 3;  // letters
constexpr std::size_t kMinContained = 3;   // letters: shorter texts are in many names by chance

/// Returns the edit distance of two texts (V. I. Levenshtein, 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

bool contains(const std::string& text, const std::string& part) {
  return part.size() >= kMinContained && text.find(part) != std::string::npos;
}

}  // namespace

std::vector<std::string> similar_names(const std::string& given,
                                       const std::vector<std::string>& names) {
  const std::string wanted = upper(given);
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& name : names) {
    const std::string other = upper(name);
    const std::size_t distance = edit_distance(wanted, other);
    if (distance <= kMaxDifference || contains(other, wanted) || contains(wanted, other)) {
      near.emplace_back(distance, name);
    }
  }
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> result;
  result.reserve(near.size());
  for (auto& [distance, name] : near) result.push_back(std::move(name));
  return result;
}

}  // namespace fpga_stereo
