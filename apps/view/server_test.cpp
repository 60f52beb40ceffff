#include "apps/view/server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <tuple>
#include <vector>

#include "apps/view/http.h"
#include "apps/view/test_client.h"

namespace umbrage::view {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// A running server that notes the calls of its handlers.
class ViewServer : public testing::Test {
 protected:
  struct Event {
    enum Kind { kOpened, kClosed, kReceived } kind;
    PageId page;
    std::string text;
  };

  void start(ServerSettings settings = {}) {
    settings.page = "<!DOCTYPE html><title>viewer</title>";
    ServerHandlers handlers;
    handlers.opened = [this](PageId page) { note({Event::kOpened, page, {}}); };
    handlers.closed = [this](PageId page) { note({Event::kClosed, page, {}}); };
    handlers.received = [this](PageId page, std::string text) { note({Event::kReceived, page, std::move(text)}); };
    handlers.save = [this](const Save& save, const std::function<bool()>& is_wanted) {
      return save_ ? save_(save, is_wanted) : error_answer(400, "nothing is saved");
    };
    auto started = Server::start(settings, std::move(handlers));
    ASSERT_TRUE(started) << started.error().message;
    server_ = std::move(*started);
    const std::string address = server_->address();
    const std::size_t colon = address.rfind(':'), slash = address.find('/', colon);
    port_ = std::stoi(address.substr(colon + 1));
    path_ = address.substr(slash, address.size() - slash - 1);
  }

  void note(Event event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
    changed_.notify_all();
  }

  /// Waits for the next event and returns it.
  Event next() {
    std::unique_lock lock(mutex_);
    Event event{Event::kClosed, -1, "nothing happened"};
    if (!changed_.wait_for(lock, 10s, [this] { return seen_ < events_.size(); })) ADD_FAILURE() << event.text;
    return seen_ < events_.size() ? events_[seen_++] : event;
  }

  /// Sends a request and returns the complete answer.
  std::string ask(const std::string& method, const std::string& path, const std::string& headers = "",
                  const std::string& body = "") {
    TestClient client(port_);
    const bool has_origin = headers.find("Origin: ") != std::string::npos;
    std::string request = method + " " + path + " HTTP/1.1\r\n" + headers;
    if (!has_origin) request += client.origin();
    if (method == "POST") request += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    client.send(request + "\r\n" + body);
    return client.rest();
  }

  static int status(const std::string& answer) {
    return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9)) : -1;
  }
  static std::string body(const std::string& answer) {
    return answer.substr(std::min(answer.find("\r\n\r\n") + 4, answer.size()));
  }

  /// Returns a page that is connected, and its id.
  TestClient page(PageId& id, int receive_buffer = 0) {
    TestClient client(port_, receive_buffer);
    const std::string answer = client.open_web_socket(path_ + "/socket");
    EXPECT_EQ(status(answer), 101) << answer;
    const Event event = next();
    EXPECT_EQ(event.kind, Event::kOpened);
    id = event.page;
    return client;
  }

  std::function<HttpAnswer(const Save&, const std::function<bool()>&)> save_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Event> events_;
  std::size_t seen_ = 0;
  std::unique_ptr<Server> server_;  // last: ends before what its handlers use
  int port_ = 0;
  std::string path_;  ///< /TOKEN
};

TEST_F(ViewServer, ServesThePageBelowTheTokenAlone) {
  start();
  EXPECT_EQ(path_.size(), 33u);
  EXPECT_EQ(path_.find_first_not_of("0123456789abcdef", 1), std::string::npos);
  const std::string page = ask("GET", path_ + "/");
  EXPECT_EQ(status(page), 200);
  EXPECT_EQ(body(page), "<!DOCTYPE html><title>viewer</title>");
  for (const char* header : {"Cache-Control: no-store", "Content-Security-Policy: default-src 'none'; ",
                             "X-Content-Type-Options: nosniff", "Referrer-Policy: no-referrer"})
    EXPECT_NE(page.find(header), std::string::npos) << header;
  EXPECT_EQ(page.find("Access-Control-Allow"), std::string::npos);
  const std::string head = ask("HEAD", path_ + "/");
  EXPECT_EQ(status(head), 200);
  EXPECT_EQ(body(head), "");
  const std::string moved = ask("GET", path_);
  EXPECT_EQ(status(moved), 308);
  EXPECT_NE(moved.find("\r\nLocation: " + path_.substr(1) + "/\r\n"), std::string::npos);
  std::string wrong = path_;
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& path :
       {std::string("/"), wrong + "/", path_ + "0/", path_.substr(0, 32) + "/", "/x" + path_ + "/", path_ + "/other",
        path_ + "/files/../", path_ + "/%2e%2e/", path_ + "//etc/passwd"})
    EXPECT_EQ(status(ask("GET", path)), 404) << path;
  EXPECT_EQ(status(ask("POST", wrong + "/files?drop=a&name=b", "", "x")), 404);
  EXPECT_EQ(status(ask("DELETE", path_ + "/")), 405);
  EXPECT_EQ(status(ask("POST", path_ + "/", "", "x")), 405);
  EXPECT_EQ(status(ask("GET", path_ + "/files")), 405);
  EXPECT_EQ(status(ask("OPTIONS", path_ + "/save", "Access-Control-Request-Method: POST\r\n")), 405);
  EXPECT_EQ(status(ask("GET", path_ + "/socket")), 426);
  EXPECT_EQ(status(TestClient(port_).open_web_socket(wrong + "/socket")), 404);
}

TEST_F(ViewServer, RefusesOtherHostsAndOrigins) {
  start({.host_names = {"Viewer.example", "tunnel.example:9000"}});
  const std::string port = ":" + std::to_string(port_), here = "127.0.0.1" + port;
  const auto statuses = [&](const std::string& headers) {
    return std::vector<int>{status(TestClient(port_).open_web_socket(path_ + "/socket", headers)),
                            status(ask("POST", path_ + "/files?drop=a&name=b", headers, "x")),
                            status(ask("POST", path_ + "/save", headers, "{}")),
                            status(ask("GET", path_ + "/", headers))};
  };
  const std::vector<int> refused(4, 403);
  for (const std::string& origin :
       {std::string("http://example.org"), std::string("null"), std::string("http://127.0.0.1"),
        "http://127.0.0.1.example.org" + port, "https://" + here, "ws://" + here, "file://" + here, here, std::string(),
        "http://" + here + "/", "http://" + here + "\r\nOrigin: http://" + here, "http://localhost" + port})
    EXPECT_EQ(statuses("Host: " + here + "\r\nOrigin: " + origin + "\r\n"), refused) << origin;
  for (const std::string& host : {std::string("example.org"), "example.org" + port, std::string("127.0.0.1"),
                                  std::string("127.0.0.1:1"), "tunnel.example" + port, "127.0.0.1.example.org" + port,
                                  std::string(), here + "\r\nHost: " + here, "x@" + here})
    EXPECT_EQ(statuses("Host: " + host + "\r\nOrigin: http://" + host + "\r\n"), refused) << host;
  EXPECT_EQ(statuses("Origin: http://" + here + "\r\n"), refused);
  EXPECT_TRUE(fs::is_empty(server_->uploads()));
  TestClient client(port_);
  client.send("POST " + path_ + "/save HTTP/1.1\r\nHost: " + here + "\r\nContent-Length: 2\r\n\r\n{}");
  EXPECT_EQ(status(client.rest()), 403);  // no Origin
  int number = 0;
  for (const std::string& host : {here, "localhost" + port, "LocalHost" + port, "[::1]" + port, "viewer.example" + port,
                                  std::string("tunnel.example:9000")}) {
    const std::string headers = "Host: " + host + "\r\nOrigin: HTTP://" + host + "\r\n";
    EXPECT_EQ(status(TestClient(port_).open_web_socket(path_ + "/socket", headers)), 101) << host;
    EXPECT_EQ(status(ask("POST", path_ + "/files?drop=a&name=" + std::to_string(++number), headers, "x")), 200) << host;
    EXPECT_EQ(status(ask("GET", path_ + "/", headers)), 200) << host;
  }
}

TEST_F(ViewServer, MessagesGoBothWays) {
  start();
  PageId id = 0;
  TestClient client = page(id);
  client.send_message(TestClient::kText, "hello");
  Event event = next();
  EXPECT_EQ(event.kind, Event::kReceived);
  EXPECT_EQ(event.page, id);
  EXPECT_EQ(event.text, "hello");
  // A message in pieces, with a ping between them.
  client.send_message(TestClient::kText, "in ", false);
  client.send_message(TestClient::kPing, "p");
  client.send_message(TestClient::kContinuation, "three ", false);
  client.send_message(TestClient::kContinuation, "pieces");
  EXPECT_EQ(client.message().data, "p");
  EXPECT_EQ(next().text, "in three pieces");
  server_->send_text(id, "a text");
  const std::string frame = frame_bytes({{"view", 0}}, std::string(100000, 'x'));
  server_->send_frame(id, frame);
  EXPECT_EQ(client.message().data, "a text");
  const auto received = client.message();
  EXPECT_EQ(received.opcode, TestClient::kBinary);
  EXPECT_TRUE(received.data == frame);
  server_->send_text(id + 1, "lost");
  client.send_message(TestClient::kClose, "");
  EXPECT_EQ(client.message().opcode, TestClient::kClose);
  event = next();
  EXPECT_EQ(event.kind, Event::kClosed);
  EXPECT_EQ(event.page, id);
  server_->send_text(id, "gone");
}

TEST_F(ViewServer, WrongFramesCloseTheirPage) {
  start();
  PageId other_id = 0;
  TestClient other = page(other_id);
  const std::pair<std::string, int> cases[] = {
      {TestClient::frame(0x81, "x", 0), 1002},
      {TestClient::frame(0x82, "x"), 1003},
      {TestClient::frame(0x81, "\xff"), 1007},
      {"\x81\xff" + std::string("\0\0\0\0\x80\0\0\0", 8), 1009},  // 2 GiB, of which none has come
      {TestClient::frame(0x88, "\x0f\xa0"), 4000}};
  for (const auto& [bytes, code] : cases) {
    PageId id = 0;
    TestClient client = page(id);
    client.send(bytes);
    const auto answer = client.message();
    EXPECT_EQ(answer.opcode, TestClient::kClose) << code;
    EXPECT_TRUE(answer.data.starts_with(std::string{char(code >> 8), char(code)})) << code;
    EXPECT_EQ(next().page, id) << code;
    EXPECT_EQ(client.rest(), "") << code;
  }
  other.send_message(TestClient::kText, std::string(kMaxMessageBytes, 'x'));
  EXPECT_EQ(next().text.size(), kMaxMessageBytes);
}

TEST_F(ViewServer, ClientsWithoutTheTokenDelayNoPage) {
  start();
  std::vector<TestClient> clients;
  const auto expect_quick = [&](const char* what) {
    auto best = std::chrono::steady_clock::duration::max();
    for (int i = 0; i < 3; ++i) {  // other programs may delay one
      const auto start = std::chrono::steady_clock::now();
      EXPECT_EQ(status(ask("GET", path_ + "/")), 200) << what;
      best = std::min(best, std::chrono::steady_clock::now() - start);
    }
    EXPECT_LT(best, 200ms) << what;
  };
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(TestClient(port_).rest(), "");  // a silent one is closed
  const auto waited = std::chrono::steady_clock::now() - start;
  EXPECT_TRUE(waited > 900ms && waited < 3s) << waited / 1ms;
  const std::string origin = TestClient(port_).origin(), length = "Content-Length: 999999\r\n",
                    upload = path_ + "/files?drop=a&name=b HTTP/1.1\r\n" + length;
  const std::tuple<const char*, int, std::string> crowds[] = {
      {"60 silent ones", 60, ""},
      {"258 silent ones", 198, ""},
      {"incomplete ones", 400, "GET /"},
      {"uploads without the token", 36, "POST /0/files HTTP/1.1\r\n" + length + origin + "\r\nx"},
      {"uploads for another host", 36, "POST " + upload + "Host: example.org\r\n\r\nx"},
      {"uploads with the token", 36, "POST " + upload + origin + "\r\nx"},
      {"wrong tokens", 100, "GET /0/ HTTP/1.1\r\nConnection: keep-alive\r\n" + origin + "\r\n"}};
  for (const auto& [name, count, bytes] : crowds) {
    for (int i = 0; i < count; ++i) clients.emplace_back(port_).send(bytes);
    expect_quick(name);
  }
  EXPECT_EQ(status(clients.back().rest()), 404);  // and it is closed
  PageId id = 0;
  const TestClient connected = page(id);
  EXPECT_EQ(status(ask("POST", path_ + "/save", "", "{}")), 400);
  // One byte at a time: none reaches the end of its head within a second.
  clients.clear();
  for (int i = 0; i < 60; ++i) clients.emplace_back(port_);
  const std::string head = "GET " + path_ + "/ HTTP/1.1\r\n" + origin + "X: ";
  const auto dripping = std::chrono::steady_clock::now();
  for (std::size_t i = 0; std::chrono::steady_clock::now() - dripping < 1500ms; ++i) {
    for (TestClient& client : clients) client.send(std::string_view(head).substr(std::min(i, head.size() - 1), 1));
    if (i % 8 == 0) expect_quick("60 that send a byte at a time");
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_EQ(clients[0].rest(), "");
}

TEST_F(ViewServer, OnePageTooManyIsRefused) {
  start({.max_pages = 2});
  PageId first = 0, second = 0;
  TestClient one = page(first);
  const TestClient two = page(second);
  TestClient three(port_);
  EXPECT_EQ(status(three.open_web_socket(path_ + "/socket")), 101);
  EXPECT_NE(three.message().data.find("2 pages open"), std::string::npos);
  EXPECT_EQ(three.message().opcode, TestClient::kClose);
  three.close();
  one.close();
  const Event event = next();
  EXPECT_EQ(event.kind, Event::kClosed);
  EXPECT_EQ(event.page, first);
  PageId fourth = 0;
  const TestClient four = page(fourth);
  EXPECT_GT(fourth, second);
}

TEST_F(ViewServer, ASlowPageDelaysNobodyAndIsClosed) {
  start({.stall_ms = 3000});
  PageId slow_id = 0, quick_id = 0;
  const TestClient slow = page(slow_id, 4096);
  TestClient quick = page(quick_id);
  const std::string picture(4 << 20, 'x');
  for (int i = 0; i < 10; ++i) {
    const std::string frame = frame_bytes({{"frame", i}, {"view", 0}}, picture);
    server_->send_frame(slow_id, frame);
    server_->send_frame(quick_id, frame);
    EXPECT_EQ(quick.message().data.size(), frame.size());
  }
  {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(seen_, events_.size());  // all frames arrived while the slow page was still waited for
  }
  const Event event = next();
  EXPECT_EQ(event.kind, Event::kClosed);
  EXPECT_EQ(event.page, slow_id);
  server_->send_text(quick_id, "still here");
  EXPECT_EQ(quick.message().data, "still here");
}

TEST_F(ViewServer, APageWithTooManyWaitingTextsIsClosed) {
  start();
  PageId id = 0;
  const TestClient client = page(id, 4096);
  for (int i = 0; i < 40; ++i) server_->send_text(id, std::string(1 << 20, 'x'));
  EXPECT_EQ(next().kind, Event::kClosed);
}

TEST_F(ViewServer, TheEndClosesEverything) {
  start();
  const fs::path folder = server_->uploads();
  ask("POST", path_ + "/files?drop=a&name=b", "", "x");
  PageId id = 0, stalled_id = 0;
  TestClient client = page(id);
  TestClient stalled = page(stalled_id);
  stalled.send("\x81");  // the start of a message that never ends
  const TestClient silent(port_);
  const auto started = std::chrono::steady_clock::now();
  server_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - started, 8s);
  EXPECT_EQ(client.message().opcode, TestClient::kClose);
  EXPECT_EQ(std::count_if(events_.begin(), events_.end(), [](const Event& e) { return e.kind == Event::kClosed; }), 2);
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(ViewServer, PagesThatComeAndGoLeaveNothing) {
  start();
  const auto files = [] { return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()); };
  const auto threads = [] {
    return std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator());
  };
  const auto files_before = files(), threads_before = threads();
  for (int i = 0; i < 200; ++i) {
    PageId id = 0;
    TestClient client = page(id);
    if (i % 2 == 0) client.send_message(TestClient::kClose, "");
    client.close();
    EXPECT_EQ(next().kind, Event::kClosed);
  }
  for (int i = 0; i < 100 && files() > files_before; ++i) std::this_thread::sleep_for(20ms);
  EXPECT_EQ(files(), files_before);
  EXPECT_EQ(threads(), threads_before);
}

TEST_F(ViewServer, UploadsAreStoredWithinLimits) {
  start({.uploads = {.drop = 1000, .total = 1500, .files = 4}});
  const auto post = [&](const std::string& query, const std::string& content) {
    return ask("POST", path_ + "/files?" + query, "", content);
  };
  const std::string stored = post("drop=a1&name=bunny%20%26%20co.obj", std::string(600, 'x'));
  EXPECT_EQ(status(stored), 200);
  EXPECT_EQ(body(stored), R"({"file":"a1/bunny & co.obj"})");
  const auto path = server_->upload("a1/bunny & co.obj");
  ASSERT_TRUE(path);
  EXPECT_EQ(text_of(*path), std::string(600, 'x'));
  EXPECT_EQ(fs::status(server_->uploads()).permissions(), fs::perms::owner_all);
  EXPECT_EQ(body(post("drop=a1&name=..%2F..%2Fetc%2Fnames", "x")), R"({"file":"a1/names"})");
  EXPECT_EQ(body(post("drop=a1&name=C%3A%5Cscene.mtl", "")), R"({"file":"a1/scene.mtl"})");
  for (const char* query : {"drop=a1", "drop=a1&name=", "drop=a1&name=..", "drop=a1&name=.", "drop=a1&name=a%2F",
                            "drop=a1&name=a%0Ab", "drop=a1&name=a%00b", "drop=..&name=a", "drop=&name=a", "name=a",
                            "drop=A&name=a", "drop=a%2Fb&name=a", "drop=123456789012345678901234567890123&name=a"})
    EXPECT_EQ(status(post(query, "x")), 400) << query;
  EXPECT_EQ(status(post("drop=a1&name=" + std::string(256, 'n'), "x")), 400);
  EXPECT_EQ(status(post("drop=a1&name=names", "x")), 409);
  const std::string large = post("drop=a1&name=large", std::string(400, 'x'));
  EXPECT_EQ(status(large), 413);
  EXPECT_NE(body(large).find("1000 bytes"), std::string::npos) << large;
  EXPECT_EQ(status(post("drop=b&name=large", std::string(900, 'x'))), 413);
  EXPECT_EQ(status(post("drop=b&name=small", "x")), 200);
  EXPECT_EQ(status(post("drop=b&name=fifth", "x")), 413);
  EXPECT_EQ(status(ask("POST", path_ + "/files?drop=c&name=d", "Transfer-Encoding: chunked\r\n", "")), 411);
  for (const char* file : {"a1/../a1/names", "/etc/passwd", "a1", "", "b/fifth"})
    EXPECT_FALSE(server_->upload(file)) << file;
}

TEST_F(ViewServer, AnIncompleteUploadIsRemoved) {
  start({.uploads = {.drop = 1000}});
  for (int i = 0; i < 3; ++i) {
    TestClient client(port_);
    client.send("POST " + path_ + "/files?drop=a&name=b" + std::to_string(i) + " HTTP/1.1\r\n" + client.origin() +
                "Content-Length: 300\r\n\r\nstart");
    for (int wait = 0; wait < 500 && !fs::exists(server_->uploads() / "a" / ("b" + std::to_string(i))); ++wait)
      std::this_thread::sleep_for(10ms);
    EXPECT_FALSE(server_->upload("a/b" + std::to_string(i)));
    EXPECT_EQ(status(ask("POST", path_ + "/files?drop=a&name=c", "", std::string(701, 'x'))), 413);
  }
  // The space that was reserved is free again after a moment.
  int last = 0;
  for (int wait = 0; wait < 500 && last != 200; ++wait) {
    last = status(ask("POST", path_ + "/files?drop=a&name=c", "", std::string(1000, 'x')));
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(last, 200);
  EXPECT_EQ(std::distance(fs::directory_iterator(server_->uploads() / "a"), fs::directory_iterator()), 1);
}

TEST_F(ViewServer, ASlowUploadEnds) {
  start({.stall_ms = 500});
  TestClient client(port_);
  client.send("POST " + path_ + "/files?drop=a&name=b HTTP/1.1\r\n" + client.origin() +
              "Content-Length: 30000\r\n\r\n");
  const auto started = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - started < 1500ms && client.send("x")) std::this_thread::sleep_for(20ms);
  EXPECT_EQ(status(client.rest()), 500);
  EXPECT_FALSE(fs::exists(server_->uploads() / "a" / "b"));
  EXPECT_EQ(status(ask("POST", path_ + "/files?drop=a&name=b", "", "x")), 200);
}

TEST_F(ViewServer, SavesAreAnsweredAndCancelled) {
  start();
  const fs::path file = server_->uploads() / "saved.png";
  std::atomic<bool> waiting = false, cancelled = false;
  save_ = [&](const Save& save, const std::function<bool()>& is_wanted) -> HttpAnswer {
    if (save.format == "png") {
      std::ofstream(file, std::ios::binary) << "a picture";
      return {.type = "image/png", .file = file, .attachment = "bunny \"1\".png"};
    }
    waiting = true;
    for (int i = 0; i < 500 && is_wanted(); ++i) std::this_thread::sleep_for(10ms);
    cancelled = !is_wanted();
    return error_answer(400, "cancelled");
  };
  const std::string request = R"({"options":{},"model":0,"format":"png","width":8,"height":8})";
  const std::string saved = ask("POST", path_ + "/save", "", request);
  EXPECT_EQ(status(saved), 200);
  EXPECT_EQ(body(saved), "a picture");
  EXPECT_NE(saved.find("Content-Disposition: attachment; filename=\"bunny__1_.png\"\r\n"), std::string::npos) << saved;
  EXPECT_FALSE(fs::exists(file));
  const std::string wrong = ask("POST", path_ + "/save", "", "{}");
  EXPECT_EQ(status(wrong), 400);
  EXPECT_NE(body(wrong).find("lacks its options"), std::string::npos) << wrong;
  EXPECT_EQ(status(ask("POST", path_ + "/save", "", std::string(kMaxMessageBytes + 1, ' '))), 413);
  TestClient client(port_);
  std::string slow = request;
  slow.replace(slow.find("png"), 3, "exr");
  client.send("POST " + path_ + "/save HTTP/1.1\r\n" + client.origin() +
              "Content-Length: " + std::to_string(slow.size()) + "\r\n\r\n" + slow);
  for (int i = 0; i < 500 && !waiting; ++i) std::this_thread::sleep_for(10ms);
  client.close();
  for (int i = 0; i < 500 && !cancelled; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(cancelled);
}

TEST(ViewServerStart, ErrorsNameTheOption) {
  const auto start = [](const std::string& host, int port) { return Server::start({.host = host, .port = port}, {}); };
  const auto first = start("127.0.0.1", 0);
  ASSERT_TRUE(first);
  const std::string address = (*first)->address();
  EXPECT_TRUE(address.starts_with("http://127.0.0.1:")) << address;
  EXPECT_EQ((*first)->warning(), "");
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  EXPECT_GT(port, 0);
  const auto second = start("127.0.0.1", port);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kUsage);
  EXPECT_NE(second.error().message.find(fmt::format("--port {} is in use", port)), std::string::npos)
      << second.error().message;
  for (const char* host : {"192.0.2.1", "no such host", "::1", ""}) {
    const auto failed = start(host, 0);
    ASSERT_FALSE(failed) << host;
    EXPECT_NE(failed.error().message.find("--host"), std::string::npos) << failed.error().message;
  }
  for (const char* name :
       {"", "http://viewer", "viewer/", "viewer:", "viewer:0", "viewer:65536", "a b", "[x]", "::1"}) {
    const auto failed = Server::start({.host_names = {name}}, {});
    ASSERT_FALSE(failed) << name;
    EXPECT_NE(failed.error().message.find("--host-name"), std::string::npos) << failed.error().message;
  }
  const auto open = start("0.0.0.0", 0);
  ASSERT_TRUE(open) << open.error().message;
  EXPECT_NE((*open)->warning().find("--host"), std::string::npos);
  EXPECT_EQ((*open)->address().find("0.0.0.0"), std::string::npos) << (*open)->address();
  EXPECT_NE((*open)->address(), address);
}

}  // namespace
}  // namespace umbrage::view
