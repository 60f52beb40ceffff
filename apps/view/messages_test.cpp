#include "apps/view/messages.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

namespace umbrage::view {
namespace {

const std::string kState =
    R"({"type":"state","id":17,"moving":true,"size":[1280,720],"model":2,"views":[{"options":{"look":"studio",)"
    R"("set":["bitmask.samples=8","unsharp.strength=2"],"camera-position":"1,2,3"},"show":"normal"},)"
    R"({"options":{},"device":"cpu","goes_on":true}]})";
const std::string kOpen = R"({"type":"open","file":"a1/bunny.obj","as":"model"})";
const std::string kAck = R"({"type":"ack","frame":12})";
const std::string kPick = R"({"type":"pick","id":3,"at":[0.25,1]})";
const std::string kSave =
    R"({"options":{"look":"cartoon","camera-orthographic":"true"},"model":1,"format":"svg","width":640,"height":480})";

std::string replaced(std::string text, const std::string& old, const std::string& with) {
  const auto at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), with);
}

/// Expects an error of one line that has the text.
template <class T>
void expect_error(const Result<T>& result, const std::string& text) {
  ASSERT_FALSE(result) << text;
  EXPECT_EQ(result.error().kind, ErrorKind::kUsage);
  EXPECT_NE(result.error().message.find(text), std::string::npos) << result.error().message;
  EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
}

void expect_plain(const ViewOptions& options) {
  for (const auto& [name, values] : options) {
    EXPECT_FALSE(name.empty() || name[0] == '-' || name.find_first_of(" =\n/") != std::string::npos) << name;
    for (const std::string& value : values)
      for (const char c : value) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) << value;
  }
}

/// Checks what every accepted message guarantees.
void expect_valid(const Message& message) {
  if (const auto* state = std::get_if<State>(&message)) {
    EXPECT_TRUE(state->width >= kMinViewSide && state->width <= kMaxViewSide) << state->width;
    EXPECT_TRUE(state->height >= kMinViewSide && state->height <= kMaxViewSide) << state->height;
    EXPECT_TRUE(state->id >= 0 && state->model >= 0);
    EXPECT_TRUE(state->views.size() == 1 || state->views.size() == 2);
    for (const View& view : state->views) expect_plain(view.options);
  } else if (const auto* open = std::get_if<Open>(&message)) {
    EXPECT_TRUE(open->as == "model" || open->as == "gbuffer" || open->as == "environment");
    EXPECT_EQ(open->file.find('\n'), std::string::npos);
  } else if (const auto* pick = std::get_if<Pick>(&message)) {
    EXPECT_TRUE(pick->x >= 0.0 && pick->x <= 1.0 && pick->y >= 0.0 && pick->y <= 1.0) << pick->x << " " << pick->y;
  } else {
    EXPECT_GE(std::get<Ack>(message).frame, 0);
  }
}

TEST(ViewMessages, MessagesAreRead) {
  const auto message = parse_message(kState);
  ASSERT_TRUE(message) << message.error().message;
  const auto& state = std::get<State>(*message);
  EXPECT_EQ(state.id, 17);
  EXPECT_TRUE(state.moving);
  EXPECT_EQ(state.width, 1280);
  EXPECT_EQ(state.height, 720);
  EXPECT_EQ(state.model, 2);
  ASSERT_EQ(state.views.size(), 2u);
  EXPECT_EQ(state.views[0].show, "normal");
  EXPECT_EQ(state.views[0].options.at("set"), (std::vector<std::string>{"bitmask.samples=8", "unsharp.strength=2"}));
  EXPECT_EQ(state.views[0].options.at("camera-position"), std::vector<std::string>{"1,2,3"});
  EXPECT_EQ(state.views[1].show, "picture");
  EXPECT_EQ(state.views[1].device, "cpu");
  EXPECT_TRUE(state.views[1].goes_on);
  EXPECT_FALSE(state.views[0].goes_on);
  const auto open = parse_message(kOpen);
  ASSERT_TRUE(open);
  EXPECT_EQ(std::get<Open>(*open).file, "a1/bunny.obj");
  const auto ack = parse_message(kAck);
  ASSERT_TRUE(ack);
  EXPECT_EQ(std::get<Ack>(*ack).frame, 12);
  const auto pick = parse_message(kPick);
  ASSERT_TRUE(pick);
  EXPECT_EQ(std::get<Pick>(*pick).id, 3);
  EXPECT_EQ(std::get<Pick>(*pick).x, 0.25);
  EXPECT_EQ(std::get<Pick>(*pick).y, 1.0);
  const auto save = parse_save(kSave);
  ASSERT_TRUE(save);
  EXPECT_EQ(save->format, "svg");
  EXPECT_EQ(save->width, 640);
  EXPECT_EQ(save->height, 480);
  EXPECT_EQ(save->model, 1);
  EXPECT_EQ(save->options.at("camera-orthographic"), std::vector<std::string>{"true"});
}

TEST(ViewMessages, ErrorsAreOneSentence) {
  expect_error(parse_message(""), "not valid JSON");
  expect_error(parse_message("[1]"), "must be a JSON object");
  expect_error(parse_message("{}"), "lacks its type");
  expect_error(parse_message(R"({"type":"hello"})"), "must be state, open, ack or pick");
  expect_error(parse_message("{\"type\":\"\xff\"}"), "not valid JSON");
  expect_error(parse_message(std::string(60000, '[')), "deep");
  std::string deep;
  for (int i = 0; i < 10000; ++i) deep += "{\"a\":";
  expect_error(parse_message(deep), "deep");
  expect_error(parse_message(std::string(kMaxMessageBytes + 1, ' ')), "the max is 65536");
  for (const char* size : {"[1280]", "[15,720]", "[1280,8193]", "[1e999,720]", "[NaN,720]", "[1280.5,720]",
                           "[-1280,720]", "[18446744073709551615,720]", "null", "[\"1280\",720]"})
    EXPECT_FALSE(parse_message(replaced(kState, "[1280,720]", size))) << size;
  expect_error(parse_message(replaced(kState, "[1280,720]", "[1280,8193]")), "from 16 to 8192");
  expect_error(parse_message(replaced(kState, "\"id\":17", "\"id\":-1")), "the id");
  expect_error(parse_message(replaced(kState, "\"id\":17", "\"id\":9007199254740993")), "the id");
  expect_error(parse_message(replaced(kState, "\"id\":17,", "")), "lacks its id");
  expect_error(parse_message(replaced(kState, "true", "1")), "true or false");
  expect_error(parse_message(replaced(kState, "{\"options\":{},\"device\":\"cpu\",\"goes_on\":true}", "{},{},{}")),
               "one or two");
  expect_error(parse_message(replaced(kState, "\"studio\"", "7")), "--look");
  expect_error(parse_message(replaced(kState, "studio", "stu\\ndio")), "--look");
  expect_error(parse_message(replaced(kState, "\"look\"", "\"-o\"")), "name that no option has");
  expect_error(parse_message(replaced(kState, "\"look\"", "\"look=1\"")), "name that no option has");
  expect_error(parse_message(replaced(kState, "\"normal\"", "\"\"")), "the show");
  expect_error(parse_message(replaced(kOpen, "model", "program")), "not as 'program'");
  expect_error(parse_message(replaced(kAck, "12", "1.5")), "the frame");
  for (const char* at : {"[0.25]", "[0.25,1,0]", "[0.25,1.001]", "[-1e-9,1]", "[1e999,1]", "[\"0\",1]", "null"})
    EXPECT_FALSE(parse_message(replaced(kPick, "[0.25,1]", at))) << at;
  expect_error(parse_message(replaced(kPick, "0.25", "2")), "two numbers from 0 to 1");
  expect_error(parse_save(replaced(kSave, "svg", "exe")), "png, exr, svg, jpg or webp");
  expect_error(parse_save(replaced(kSave, "640", "16385")), "from 1 to 16384");
  expect_error(parse_save(replaced(kSave, "640", "0")), "from 1 to 16384");
}

TEST(ViewMessages, MutatedMessagesNeverBreakTheProgram) {
  constexpr int kMutations = 20000;
  constexpr std::string_view kPieces[] = {"[",   "]",  "{",   "}",    "\"",      ",",    ":",  "1e999",
                                          "NaN", "-1", "0.5", "null", "\\u0000", "\xff", "\\", "99999999999999999999",
                                          "true"};
  std::mt19937 random(48);
  const auto below = [&](std::size_t count) { return std::size_t(random() % count); };
  int accepted = 0;
  for (int i = 0; i < kMutations; ++i) {
    const std::string* const seeds[] = {&kState, &kOpen, &kAck, &kPick, &kSave};
    const std::size_t seed = below(std::size(seeds));
    std::string text = *seeds[seed];
    for (std::size_t changes = 1 + below(3); changes > 0 && !text.empty(); --changes) {
      const std::size_t at = below(text.size()), length = below(std::min<std::size_t>(text.size() - at, 12) + 1);
      switch (below(4)) {
        case 0:
          text[at] = char(below(256));
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          text.insert(at, kPieces[below(std::size(kPieces))]);
          break;
        default:
          text.insert(below(text.size()), text.substr(at, length));
      }
    }
    SCOPED_TRACE(text);
    const auto message = parse_message(text);
    const auto save = parse_save(text);
    accepted += message || save ? 1 : 0;
    if (message)
      expect_valid(*message);
    else
      expect_error(message, "");
    if (!save) continue;
    expect_plain(save->options);
    EXPECT_TRUE(save->width >= 1 && save->width <= 16384 && save->height >= 1 && save->height <= 16384);
  }
  // Both outcomes must be frequent; otherwise the mutations test nothing.
  EXPECT_GT(accepted, kMutations / 20);
  EXPECT_LT(accepted, kMutations / 2);
}

TEST(ViewMessages, TextsAndFramesAreMade) {
  EXPECT_EQ(error_text("no such look", 17, 1), R"({"id":17,"message":"no such look","type":"error","view":1})");
  EXPECT_EQ(error_text("\xff"), "{\"message\":\"\xef\xbf\xbd\",\"type\":\"error\"}");
  EXPECT_EQ(status_text(3, "reading", 0.5), R"({"id":3,"progress":0.5,"text":"reading","type":"status"})");
  EXPECT_EQ(environment_text("a/sky.hdr"), R"({"file":"a/sky.hdr","type":"environment"})");
  const std::string frame = frame_bytes({{"frame", 5}, {"view", 1}}, std::string("\0\xff", 2));
  const std::string header = R"({"frame":5,"view":1})";
  ASSERT_EQ(frame.size(), 4 + header.size() + 2);
  EXPECT_EQ(frame.substr(0, 4), std::string({char(header.size()), 0, 0, 0}));
  EXPECT_EQ(frame.substr(4, header.size()), header);
  EXPECT_EQ(view_of_frame(frame), 1);
  EXPECT_EQ(view_of_frame("ab"), 0);
  EXPECT_EQ(view_of_frame(frame_bytes({{"frame", 5}}, "")), 0);
}

}  // namespace
}  // namespace umbrage::view
