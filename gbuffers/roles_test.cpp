// Roles by names: which layer is which, in the headers that programs write.
#include "gbuffers/roles.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "gbuffers/ids.h"

namespace {
std::atomic<long> allocations = 0;
}

// Count the work of functions that make texts, whatever the machine does beside.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace umbrage {
namespace {

/// Adds channels "part:view:layer.X" of letters, such as "RGB", or a single name after the last dot.
LayeredFile header_with(const std::vector<std::string>& channels) {
  LayeredFile header;
  header.path = "render.exr";
  header.format = "EXR";
  header.width = header.height = 4;
  for (const std::string& text : channels) {
    Channel channel;
    std::string name = text;
    if (const auto colon = name.find(':'); colon != std::string::npos) {
      channel.part = name.substr(0, colon);
      name = name.substr(colon + 1);
      const auto second = name.find(':');
      channel.view = name.substr(0, second);
      name = name.substr(second + 1);
    }
    const auto dot = name.rfind('.');
    if (dot != std::string::npos) channel.layer = name.substr(0, dot);
    channel.name = name.substr(dot == std::string::npos ? 0 : dot + 1);
    channel.index = int(header.channels.size());
    header.channels.push_back(channel);
  }
  return header;
}

Roles roles_of(const LayeredFile& header, const std::string& layer = "", const std::string& view = "") {
  const std::vector<RoleFile> files = {{Role::kDepth, true, "render.exr", layer}};
  const std::vector<LayeredFile> headers = {header};
  auto roles = find_roles(files, headers, view);
  return roles ? *roles : Roles{};
}

std::string channels_text(const LayeredFile& header, const RoleChannels& role) {
  std::string text;
  for (const int channel : role.channels)
    text += (text.empty() ? "" : " ") + header.channels[std::size_t(channel)].full_name();
  return text;
}

TEST(Roles, TheWorkGrowsAsTheNumberOfChannels) {
  const auto work = [](int count) {
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) {
      names.push_back(fmt::format("a layer with a long name {}.Z", i));
      names.push_back(fmt::format("a channel with a long name {}x", i));
      names.push_back(fmt::format("a channel with a long name {}y", i));
    }
    const LayeredFile header = header_with(names);
    const long before = allocations;
    EXPECT_EQ(groups_of(header, 0).size(), names.size());
    roles_of(header);
    return double(allocations - before);
  };
  EXPECT_LT(work(800), 2.2 * work(400));
}

TEST(Roles, VectorsAreKeptTogether) {
  // Y is no luminance and Z no depth.
  const LayeredFile header = header_with({"N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "R", "G", "B"});
  const Roles roles = roles_of(header);
  EXPECT_TRUE(roles[Role::kDepth].empty());
  EXPECT_EQ(channels_text(header, roles[Role::kNormal]), "N.X N.Y N.Z");
  EXPECT_EQ(channels_text(header, roles[Role::kPosition]), "P.X P.Y P.Z");
  EXPECT_EQ(channels_text(header, roles[Role::kBeauty]), "R G B");
}

TEST(Roles, OrderOfChannelsIsThatOfTheirMeaning) {
  const LayeredFile header = header_with({"A", "B", "G", "R", "Z", "n.z", "n.y", "n.x"});
  const Roles roles = roles_of(header);
  EXPECT_EQ(channels_text(header, roles[Role::kBeauty]), "R G B A");
  EXPECT_EQ(channels_text(header, roles[Role::kNormal]), "n.x n.y n.z");
  EXPECT_EQ(channels_text(header, roles[Role::kDepth]), "Z");
}

TEST(Roles, DepthOfTheWholePictureBeforeThatOfALayer) {
  const LayeredFile nuke = header_with({"character.Z", "character.ZBack", "character.mask", "depth.Z", "other.ZBack"});
  EXPECT_EQ(channels_text(nuke, roles_of(nuke)[Role::kDepth]), "depth.Z");
  const LayeredFile single = header_with({"R", "G", "B", "A", "Z", "ZBack", "character.Z", "custom", "mask"});
  EXPECT_EQ(channels_text(single, roles_of(single)[Role::kDepth]), "Z");
  const LayeredFile parts = header_with({"customRgb::R", "customRgb::G", "customRgb::B", "customDepth::Z"});
  EXPECT_EQ(channels_text(parts, roles_of(parts)[Role::kDepth]), "customDepth.Z");
  EXPECT_EQ(roles_of(parts)[Role::kBeauty].channels.size(), 3u);
  const LayeredFile production = header_with({"rgba_main::R", "rgba_main::G", "rgba_main::B", "depth_main::depth.Z"});
  EXPECT_EQ(channels_text(production, roles_of(production)[Role::kDepth]), "depth_main.depth.Z");
}

TEST(Roles, ALayerWithTheNameOfAnotherPlaneIsNoDepth) {
  for (const char* name : {"ao", "shadow", "occlusion.Y", "outline"})
    EXPECT_TRUE(roles_of(header_with({name}))[Role::kDepth].empty()) << name;
  EXPECT_EQ(roles_of(header_with({"Y"}))[Role::kDepth].channels.size(), 1u);
}

TEST(Roles, LayerOfAnotherRoleIsNoBeauty) {
  const LayeredFile parts = header_with({"depth::Z", "normal::R", "normal::G", "normal::B"});
  EXPECT_EQ(roles_of(parts)[Role::kNormal].channels.size(), 3u);
  EXPECT_TRUE(roles_of(parts)[Role::kBeauty].empty());
  // The name of an array says what it is.
  LayeredFile arrays = header_with({"depth::Y", "flow::R", "flow::G", "flow::B"});
  arrays.format = "NPZ";
  EXPECT_TRUE(roles_of(arrays)[Role::kBeauty].empty());
  LayeredFile named = header_with({"depth::Y", "rgb::R", "rgb::G", "rgb::B"});
  named.format = "NPZ";
  EXPECT_EQ(roles_of(named)[Role::kBeauty].channels, (std::vector<int>{1, 2, 3}));
}

TEST(Roles, ArraysOfAnotherSizeAreListed) {
  LayeredFile header = header_with({"depth::Y"});
  header.format = "NPZ";
  header.attributes.emplace_back("normal", "array of 2 x 9 x 3");
  header.attributes.emplace_back("focal", "35");
  const std::vector<std::string> list = layer_list(header);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_NE(list[1].find("normal (array of 2 x 9 x 3"), std::string::npos) << list[1];
  EXPECT_NE(list[1].find("4 x 4"), std::string::npos) << list[1];
}

TEST(Roles, CoverageAloneIsNoBeauty) {
  const LayeredFile header = header_with({"rgb::R", "rgb::G", "rgb::B", "RGBA::A", "depth::Z"});
  EXPECT_EQ(roles_of(header)[Role::kBeauty].channels, (std::vector<int>{0, 1, 2}));
}

TEST(Roles, ExactDepthBeforeThatOfADenoiser) {
  const LayeredFile header = header_with({"ViewLayer.Denoising Depth.Z", "ViewLayer.Depth.Z", "ViewLayer.Mist.Z"});
  EXPECT_EQ(channels_text(header, roles_of(header)[Role::kDepth]), "ViewLayer.Depth.Z");
  const LayeredFile only = header_with({"ViewLayer.Denoising Depth.Z", "ViewLayer.Mist.Z", "ViewLayer.AO.R"});
  EXPECT_EQ(channels_text(only, roles_of(only)[Role::kDepth]), "ViewLayer.Denoising Depth.Z");
  EXPECT_EQ(roles_of(only).depth_hint, DepthHint::kDistance);
}

TEST(Roles, LayersOfOneViewLayerGoTogether) {
  const LayeredFile header = header_with({"Back.Normal.X", "Back.Normal.Y", "Back.Normal.Z", "Front.Depth.Z",
                                          "Front.Normal.X", "Front.Normal.Y", "Front.Normal.Z"});
  EXPECT_EQ(channels_text(header, roles_of(header)[Role::kNormal]), "Front.Normal.X Front.Normal.Y Front.Normal.Z");
  const LayeredFile two = header_with({"Back.Depth.Z", "Front.Depth.Z"});
  EXPECT_EQ(channels_text(two, roles_of(two, "Front")[Role::kDepth]), "Front.Depth.Z");
}

TEST(Roles, ViewsAreNotMixed) {
  const LayeredFile header =
      header_with({"rgba_right:right:R", "rgba_right:right:G", "rgba_right:right:B", "depth_left:left:Z",
                   "rgba_left:left:R", "rgba_left:left:G", "rgba_left:left:B", "depth_right:right:Z"});
  const Roles right = roles_of(header), left = roles_of(header, "", "left");
  EXPECT_EQ(right.view, "right");
  EXPECT_EQ(right[Role::kDepth].channels, std::vector<int>{7});
  EXPECT_EQ(left[Role::kDepth].channels, std::vector<int>{3});
  EXPECT_EQ(left[Role::kBeauty].channels, (std::vector<int>{4, 5, 6}));
  const std::vector<RoleFile> files = {{Role::kDepth, true, "render.exr", ""}};
  const std::vector<LayeredFile> headers = {header};
  const auto wrong = find_roles(files, headers, "lefy");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("left"), std::string::npos);
}

TEST(Roles, LayerByOption) {
  const LayeredFile header = header_with({"a.R", "a.G", "a.B", "my depth.V", "x.N.X", "x.N.Y", "x.N.Z"});
  const std::vector<LayeredFile> headers = {header, header};
  std::vector<RoleFile> files = {{Role::kDepth, false, "render.exr", "My Depth"},
                                 {Role::kNormal, false, "render.exr", "x.N"}};
  auto roles = find_roles(files, headers, "");
  ASSERT_TRUE(roles);
  EXPECT_EQ((*roles)[Role::kDepth].channels, std::vector<int>{3});
  EXPECT_EQ((*roles)[Role::kNormal].channels, (std::vector<int>{4, 5, 6}));
  files[0].layer = "nothing";
  const auto wrong = find_roles(files, headers, "");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
  EXPECT_NE(wrong.error().message.find("my depth (V)"), std::string::npos) << wrong.error().message;
}

TEST(Roles, ChannelsOfOneLetterMoreMakeAVector) {
  const LayeredFile header = header_with({"Nx", "Ny", "Nz", "depth"});
  const Roles roles = roles_of(header);
  EXPECT_EQ(roles[Role::kNormal].channels, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(roles[Role::kDepth].channels, std::vector<int>{3});
}

TEST(Roles, IndirectLightOfCyclesIsMultipliedByItsColor) {
  const LayeredFile cycles = header_with({"V.Diffuse Indirect.R", "V.Diffuse Indirect.G", "V.Diffuse Indirect.B",
                                          "V.Diffuse Color.R", "V.Diffuse Color.G", "V.Diffuse Color.B"});
  EXPECT_EQ(roles_of(cycles)[Role::kIndirectColor].channels, (std::vector<int>{3, 4, 5}));
  const LayeredFile arnold = header_with(
      {"diffuse_indirect.R", "diffuse_indirect.G", "diffuse_indirect.B", "albedo.R", "albedo.G", "albedo.B"});
  EXPECT_EQ(roles_of(arnold)[Role::kIndirect].channels, (std::vector<int>{0, 1, 2}));
  EXPECT_TRUE(roles_of(arnold)[Role::kIndirectColor].empty());
}

TEST(Roles, CryptomatteIsNoDepthAndGivesIds) {
  LayeredFile header = header_with({"crypto_object00.R", "crypto_object00.G", "crypto_object00.B", "crypto_object00.A",
                                    "crypto_material00.R", "crypto_material00.G", "crypto_material00.B",
                                    "crypto_material00.A", "crypto_object.R", "crypto_object.G", "crypto_object.B"});
  EXPECT_TRUE(roles_of(header)[Role::kDepth].empty());
  const auto objects = find_cryptomatte(header, 0, false), materials = find_cryptomatte(header, 0, true);
  ASSERT_TRUE(objects && materials);
  EXPECT_EQ(objects->channels, std::vector<int>{0});
  EXPECT_EQ(materials->channels, std::vector<int>{4});
  // A name of one's own is declared in the header.
  LayeredFile own = header_with({"mine00.R", "mine00.G", "mine00.B", "mine00.A"});
  EXPECT_FALSE(find_cryptomatte(own, 0, false));
  own.attributes.emplace_back("cryptomatte/2ae4678/name", "mine");
  EXPECT_TRUE(find_cryptomatte(own, 0, false));
}

/// Returns the planes of stored ids.
Result<RawPlanes> raw_ids(const Image& stored) {
  LayeredFile header;
  header.width = stored.width;
  header.height = stored.height;
  Roles roles;
  for (std::size_t c = 0; c < stored.planes.size(); ++c) roles[Role::kObjectId].channels.push_back(int(c));
  RawReading reading;
  reading.read_rows = [&](const auto&, auto, const TakeLayerRows& take) { return take(stored, 0); };
  return RawPlanes::read(std::array{header}, roles, reading);
}

TEST(Ids, FloatsWithAnyBitsAndColoursBecomeSmallIntegers) {
  Image stored(4, 1);
  const std::uint32_t bits[4] = {0x7fc00001u, 0u, 0x7fc00002u, 0x3f800000u};  // two are NaN as floats
  Plane& plane = stored.add(raw_plane(Role::kObjectId, 0)) = Plane(4, 1);
  for (int x = 0; x < 4; ++x) plane.at(x, 0) = std::bit_cast<float>(bits[x]);
  const auto raw = raw_ids(stored);
  ASSERT_TRUE(raw);
  const auto table = collect_ids(*raw, Role::kObjectId, true);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->index_of(bits[1]), -1.0f);
  EXPECT_NE(table->index_of(bits[0]), table->index_of(bits[2]));
  EXPECT_GE(table->index_of(bits[3]), 0.0f);
  EXPECT_EQ(table->index_of(12345u), -1.0f);
  Image colors(2, 1);
  for (int c = 0; c < 3; ++c) {
    Plane& channel = colors.add(raw_plane(Role::kObjectId, std::size_t(c))) = Plane(2, 1);
    channel.at(0, 0) = float(10 + c);
    channel.at(1, 0) = float(12 - c);
  }
  const auto colored = raw_ids(colors);
  EXPECT_EQ(collect_ids(*colored, Role::kObjectId, false)->ids, (std::vector<std::uint32_t>{0x0a0b0cu, 0x0c0b0au}));
}

TEST(Roles, EndsOfNamesCountLessThanWholeNames) {
  const LayeredFile header = header_with({"Z", "Denoising Depth.Z", "FinalImage_BumpNormal.X",
                                          "FinalImage_BumpNormal.Y", "FinalImage_BumpNormal.Z", "N.X", "N.Y", "N.Z",
                                          "Glossy Color.R", "Glossy Color.G", "Glossy Color.B"});
  const Roles roles = roles_of(header);
  EXPECT_EQ(channels_text(header, roles[Role::kDepth]), "Z");
  EXPECT_EQ(channels_text(header, roles[Role::kNormal]), "N.X N.Y N.Z");
  EXPECT_TRUE(roles[Role::kBeauty].empty());
}

TEST(Roles, OneChannelCanBeNamed) {
  const LayeredFile header = header_with({"R", "G", "B", "A", "P.X", "P.Y", "P.Z"});
  EXPECT_EQ(channels_text(header, roles_of(header, "B")[Role::kDepth]), "B");
  EXPECT_EQ(channels_text(header, roles_of(header, "P.Z")[Role::kDepth]), "P.Z");
}

TEST(Roles, ThreeFilesAreOneVector) {
  EXPECT_EQ(component_files("x.png,y.png,z.png"), (std::vector<std::string>{"x.png", "y.png", "z.png"}));
  EXPECT_EQ(component_files("shots,take,2/x.png").size(), 1u);
  std::vector<RoleFile> files = {{Role::kDepth, true, "d.png", ""}};
  for (const char* name : {"x.png", "y.png", "z.png"}) files.push_back({Role::kNormal, false, name, "", true});
  std::vector<LayeredFile> headers(4, header_with({"Y"}));
  const auto roles = find_roles(files, headers, "");
  ASSERT_TRUE(roles);
  EXPECT_EQ((*roles)[Role::kNormal].files, (std::vector{1, 2, 3}));
  EXPECT_EQ((*roles)[Role::kNormal].channels, (std::vector{0, 0, 0}));
}

}  // namespace
}  // namespace umbrage
