// Models compressed by gzip: every reader inflates them, and damaged ones are refused.
#include <gtest/gtest.h>

#include "archives.h"
#include "run_program.h"

namespace umbrage::test {
namespace {

constexpr const char* kTri = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
constexpr const char* kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
constexpr const char* kXyz = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
constexpr const char* kStl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "a\n";
constexpr const char* kGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";

class CompressedTest : public ProgramTest {};

TEST_F(CompressedTest, EveryReaderInflates) {
  const std::pair<const char*, const char*> models[] = {{"a.obj", kTri}, {"a.ply", kPly}, {"a.off", kOff},
                                                        {"a.xyz", kXyz}, {"a.stl", kStl}, {"a.gltf", kGltf}};
  for (const auto& [name, content] : models) {
    SCOPED_TRACE(name);
    const std::string compressed = std::string(name) + ".gz";
    write(name, content);
    write(compressed, gzip_of(content));
    good(std::string(name) + " -o plain.png --look ao --resolution 32");
    good(compressed + " -o packed.png --look ao --resolution 32");
    EXPECT_EQ(text_of(folder_ / "plain.png"), text_of(folder_ / "packed.png"));
  }
  const std::string listed = good("info a.obj.gz").out;
  EXPECT_NE(listed.find("a.obj.gz: OBJ, 4 triangles"), std::string::npos) << listed;
}

TEST_F(CompressedTest, StandardInputIsInflated) {
  write("a.obj.gz", gzip_of(kTri));
  const std::string piped = fmt::format("cd {} && cat a.obj.gz | {} - -o piped.png --look ao --resolution 32",
                                        quoted(folder_.string()), quoted(test::kProgram));
  EXPECT_EQ(std::system(piped.c_str()), 0);
  good("tri.obj -o plain.png --look ao --resolution 32");
  EXPECT_EQ(text_of(folder_ / "plain.png"), text_of(folder_ / "piped.png"));
}

TEST_F(CompressedTest, MaterialsAreFoundBesideTheFile) {
  write("m.mtl", "newmtl red\nKd 1 0 0\n");
  write("m.obj.gz", gzip_of(std::string("mtllib m.mtl\nusemtl red\n") + kTri));
  EXPECT_NE(good("info m.obj.gz").out.find("red: albedo 1, 0, 0"), std::string::npos);
}

TEST_F(CompressedTest, SeveralMembersAreOneFile) {
  const std::string text = kTri;
  write("two.obj.gz", gzip_of(text.substr(0, 30)) + gzip_of(text.substr(30)) + std::string(100, '\0'));
  EXPECT_NE(good("info two.obj.gz").out.find("4 triangles"), std::string::npos);
}

TEST_F(CompressedTest, DamagedFilesAreRefused) {
  const std::string whole = gzip_of(kPly);
  for (std::size_t size = 1; size < whole.size(); size += 7) {
    write("cut.ply.gz", whole.substr(0, size));
    bad("cut.ply.gz -o out.png", 3, {"'cut.ply.gz'", size < 3 ? "is not a gzip file" : "is cut short"});
  }
  std::string wrong = whole;
  wrong[wrong.size() - 6] ^= 1;  // the check sum
  for (const char* name : {"sum.ply.gz", "sum.off.gz", "sum.obj.gz", "sum.gltf.gz"}) {
    write(name, wrong);
    bad(std::string(name) + " -o out.png", 3, {name, "is damaged: gzip cannot inflate it"});
  }
  write("plain.obj.gz", kTri);
  bad("plain.obj.gz -o out.png", 3, {"'plain.obj.gz' is not a gzip file"});
  write("nothing.xyz.gz", gzip_of(""));
  bad("nothing.xyz.gz -o out.png", 3, {"'nothing.xyz.gz' is empty"});
  write("notes.txt.gz", gzip_of("hello"));
  bad("notes.txt.gz -o out.png", 3, {"'notes.txt.gz' is not a supported model file", "and .gz"});
}

TEST_F(CompressedTest, BombsAreRefused) {
  const std::string bomb = gzip_of(std::string(std::size_t(80) << 20, '0'));
  for (const char* name : {"bomb.xyz.gz", "bomb.obj.gz", "bomb.ply.gz"}) {
    write(name, bomb);
    bad(std::string(name) + " -o out.png", 3, {name, "to more than 67.1 MB"});
  }
}

}  // namespace
}  // namespace umbrage::test
