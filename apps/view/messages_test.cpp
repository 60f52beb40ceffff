#include "apps/view/messages.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "apps/view/http.h"
#include "apps/view/test_client.h"

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

TEST(ViewFrames, WrongOnesEndWithTheCodeOfTheStandard) {
  const auto frame = [](int start, std::string_view data) { return TestClient::frame(start, data); };
  const auto text = [&](std::string_view data) { return frame(0x81, data); };
  const auto close = [&](int code, std::string_view why = "") {
    return frame(0x88, std::string{char(code >> 8), char(code)}.append(why));
  };
  const std::string half(kMaxMessageBytes / 2, 'x');
  const struct {
    const char* name;
    std::string bytes;
    int code;
  } cases[] = {{"unmasked", TestClient::frame(0x81, "x", 0), 1002},
               {"reserved bit", frame(0xc1, "x"), 1002},
               {"reserved bit of a ping", frame(0x99, "x"), 1002},
               {"opcode 3", frame(0x83, "x"), 1002},
               {"opcode 11", frame(0x8b, "x"), 1002},
               {"continuation of nothing", frame(0x80, "x"), 1002},
               {"text within a text", frame(0x01, "x") + text("y"), 1002},
               {"ping in fragments", frame(0x09, "x"), 1002},
               {"ping of 126 bytes", frame(0x89, std::string(126, 'x')), 1002},
               {"long size of a short frame", "\x81\xfe" + std::string("\0\1mask", 6) + "x", 1002},
               {"close of one byte", frame(0x88, "x"), 1002},
               {"close 999", close(999), 1002},
               {"close 1005", close(1005), 1002},
               {"close 1015", close(1015), 1002},
               {"close 2999", close(2999), 1002},
               {"close 5000", close(5000), 1002},
               {"binary", frame(0x82, "x"), 1003},
               {"byte 255", text("\xff"), 1007},
               {"overlong", text("\xc0\x80"), 1007},
               {"surrogate", text("\xed\xa0\x80"), 1007},
               {"incomplete character", frame(0x01, "\xc3") + frame(0x80, ""), 1007},
               {"close for a reason that is not UTF-8", close(1000, "\xff"), 1007},
               {"too large", text(half + half + "x"), 1009},
               {"2 GiB, of which none has come", "\x81\xff" + std::string("\0\0\0\0\x80\0\0\0", 8), 1009},
               {"too large in fragments", frame(0x01, half) + frame(0x00, half) + frame(0x80, "x"), 1009}};
  for (const auto& each : cases)
    for (const std::size_t chunk : {std::size_t(1), each.bytes.size()}) {
      FrameReader reader;
      for (std::size_t at = 0; at < each.bytes.size() && reader.error() == CloseCode::kNone; at += chunk) {
        reader.add(std::string_view(each.bytes).substr(at, chunk));
        EXPECT_FALSE(reader.next()) << each.name;
      }
      EXPECT_EQ(int(reader.error()), each.code) << each.name;
      EXPECT_FALSE(reader.sentence().empty()) << each.name;
    }
}

TEST(ViewFrames, MessagesComeInPieces) {
  FrameReader reader;
  const std::string bytes = TestClient::frame(0x01, "\xc3") + TestClient::frame(0x89, std::string(125, 'p')) +
                            TestClient::frame(0x80, "\xa4") +
                            TestClient::frame(0x88,
                                              "\x03\xe8"
                                              "done");
  std::vector<std::pair<Opcode, std::string>> messages;
  for (const char byte : bytes + TestClient::frame(0x81, "too late")) {
    reader.add({&byte, 1});
    while (auto message = reader.next()) messages.emplace_back(message->opcode, message->data);
  }
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages[0], std::pair(Opcode::kPing, std::string(125, 'p')));
  EXPECT_EQ(messages[1], std::pair(Opcode::kText, std::string("\xc3\xa4")));
  EXPECT_EQ(messages[2], std::pair(Opcode::kClose, std::string("\x03\xe8"
                                                               "done")));
  EXPECT_EQ(reader.error(), CloseCode::kNone);
  // The example of RFC 6455.
  EXPECT_NE(
      web_socket_head("dGhlIHNhbXBsZSBub25jZQ==").find("\r\nSec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"),
      std::string::npos);
}

TEST(ViewHeads, AreParsedStrictly) {
  const auto request = parse_head(
      "POST /a/files?drop=b&name=c%20d+%zz HTTP/1.1\r\nHost: x\r\nA:\r\nCookie:  a b \r\ncookie:c\r\nContent-Length: "
      "12\r\n\r\n");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->method + " " + request->path, "POST /a/files");
  EXPECT_EQ(request->parameter("name"), "c d %zz");
  EXPECT_EQ(request->parameter("other"), "");
  EXPECT_EQ(request->header("cookie"), "a b, c");
  EXPECT_EQ(request->header("a"), "");
  EXPECT_EQ(request->content_length(), 12);
  for (const char* head :
       {"", "\r\n\r\n", "GET\r\n\r\n", "GET /\r\n\r\n", "GET / HTTP/2\r\n\r\n", "GET  / HTTP/1.1\r\n\r\n",
        "GET / HTTP/1.1 \r\n\r\n", "G\x01T / HTTP/1.1\r\n\r\n", "GET http://a/ HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\n",
        "GET / HTTP/1.1\n\n", "GET / HTTP/1.1\r\nA: b\r\n", "GET / HTTP/1.1\r\nA\r\n\r\n",
        "GET / HTTP/1.1\r\nA : b\r\n\r\n", "GET / HTTP/1.1\r\n: b\r\n\r\n", "GET / HTTP/1.1\r\nA: b\r\n c\r\n\r\n",
        "GET / HTTP/1.1\r\nA: b\nC: d\r\n\r\n", "GET / HTTP/1.1\r\n\r\n\r\n"})
    EXPECT_FALSE(parse_head(head)) << head;
  for (const char* length : {"", "-1", "+1", "1, 1", "0x1", "99999999999999999999", "1\r\nContent-Length: 1",
                             "1\r\nTransfer-Encoding: chunked"}) {
    const auto other = parse_head(std::string("GET / HTTP/1.1\r\nContent-Length: ") + length + "\r\n\r\n");
    ASSERT_TRUE(other) << length;
    EXPECT_EQ(other->content_length(), -1) << length;
  }
}

}  // namespace
}  // namespace umbrage::view
