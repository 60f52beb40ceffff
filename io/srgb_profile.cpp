#include "io/srgb_profile.h"

#include <cmath>
#include <string_view>
#include <utility>

namespace umbrage {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Appends an unsigned integer of `size` bytes, the most significant first.
void add(Bytes& to, std::uint32_t value, int size = 4) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) to.push_back(std::uint8_t(value >> shift));
}

void add(Bytes& to, std::string_view text) {
  for (const char c : text) to.push_back(std::uint8_t(c));
}

/// Appends numbers as s15Fixed16Number.
void add_fixed(Bytes& to, std::initializer_list<double> numbers) {
  constexpr double kOne = 65536.0;
  for (const double number : numbers) add(to, std::uint32_t(std::int32_t(std::lround(number * kOne))));
}

Bytes xyz(double x, double y, double z) {
  Bytes tag;
  add(tag, "XYZ ");
  add(tag, 0);
  add_fixed(tag, {x, y, z});
  return tag;
}

Bytes text(std::string_view ascii) {
  constexpr std::uint32_t kRecordSize = 12, kTextStart = 28;
  Bytes tag;
  add(tag, "mluc");
  for (const std::uint32_t field : {0u, 1u, kRecordSize}) add(tag, field);
  add(tag, "enUS");
  add(tag, std::uint32_t(2 * ascii.size()));
  add(tag, kTextStart);
  for (const char c : ascii) add(tag, std::uint32_t(c), 2);
  return tag;
}

Bytes curve() {
  constexpr std::uint32_t kType = 3;  // (a x + b)^g from d, below that c x
  Bytes tag;
  add(tag, "para");
  add(tag, 0);
  add(tag, kType, 2);
  add(tag, 0, 2);
  add_fixed(tag, {2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045});
  return tag;
}

Bytes adaptation() {  // Bradford, from D65 to D50
  Bytes tag;
  add(tag, "sf32");
  add(tag, 0);
  add_fixed(tag, {1.04788, 0.02292, -0.05022, 0.02959, 0.99048, -0.01707, -0.00925, 0.01508, 0.75168});
  return tag;
}

Bytes make_profile() {
  const std::pair<std::string_view, Bytes> tags[] = {
      {"desc", text("sRGB")},
      {"cprt", text("No copyright, use freely")},
      {"wtpt", xyz(0.9642, 1.0, 0.8249)},
      {"chad", adaptation()},
      {"rXYZ", xyz(0.43607, 0.22249, 0.01392)},
      {"gXYZ", xyz(0.38515, 0.71687, 0.09708)},
      {"bXYZ", xyz(0.14307, 0.06061, 0.71410)},
      {"rTRC", curve()},
      {"gTRC", curve()},
      {"bTRC", curve()},
  };
  constexpr std::size_t kHeaderSize = 128, kEntrySize = 12;
  Bytes table, data;
  add(table, std::uint32_t(std::size(tags)));
  const std::size_t start = kHeaderSize + 4 + kEntrySize * std::size(tags);
  std::size_t last = 0;
  for (const auto& [name, tag] : tags) {
    if (!name.ends_with("TRC") || name[0] == 'r') {  // the three curves are one
      last = start + data.size();
      for (const std::uint8_t byte : tag) data.push_back(byte);
      data.resize((data.size() + 3) / 4 * 4);
    }
    add(table, name);
    add(table, std::uint32_t(last));
    add(table, std::uint32_t(tag.size()));
  }
  Bytes profile;
  add(profile, std::uint32_t(start + data.size()));
  add(profile, 0);
  add(profile, 0x04300000);  // version
  add(profile, "mntrRGB XYZ ");
  for (const std::uint32_t part : {2026, 1, 1, 0, 0, 0}) add(profile, part, 2);  // date
  add(profile, "acsp");
  profile.resize(68);                         // platform, flags, device, rendering intent: perceptual
  add_fixed(profile, {0.9642, 1.0, 0.8249});  // D50
  profile.resize(kHeaderSize);
  for (const Bytes* part : {&table, &data})
    for (const std::uint8_t byte : *part) profile.push_back(byte);
  return profile;
}

}  // namespace

const std::vector<std::uint8_t>& srgb_profile() {
  static const Bytes profile = make_profile();
  return profile;
}

}  // namespace umbrage
