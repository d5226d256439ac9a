// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_access.hpp"

#include <catch2/catch.hpp>

namespace view_access_test {

using namespace spm::servo;

TEST_CASE("A token is 32 digits, and another one each time") {
  const auto first = make_token(), second = make_token();
  REQUIRE(first);
  REQUIRE(second);
  CHECK(first->size() == 32);
  CHECK(first->find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(*first != *second);
}

TEST_CASE("Only the whole token is granted, and what follows it is the path") {
  const std::string token = "0123456789abcdef0123456789abcdef";
  CHECK(target_of("/" + token + "/", token).granted);
  CHECK(target_of("/" + token + "/view.js?now", token).path == "view.js");
  for (const std::string& wrong :
       {std::string("/"), std::string(), "/" + token, "//" + token + "/",
        "/" + token.substr(1) + "/", "/" + token + "0/", "/ws?token=" + token, std::string("*")}) {
    CAPTURE(wrong);
    CHECK_FALSE(target_of(wrong, token).granted);
  }
}

TEST_CASE("A host is the view's own by its digits or as localhost, with its port") {
  for (const char* own : {"127.0.0.1:8080", "localhost:8080", "[::1]:8080", "192.168.1.7:8080"}) {
    CAPTURE(own);
    CHECK(is_own_host(own, 8080));
  }
  for (const char* foreign : {"", "127.0.0.1", "127.0.0.1:80", "example.org:8080", ":8080",
                              "127.0.0.1.example.org:8080", "localhost.example.org:8080"}) {
    CAPTURE(foreign);
    CHECK_FALSE(is_own_host(foreign, 8080));
  }
}

TEST_CASE("An origin is the view's own where its host is the one that was asked, by plain HTTP") {
  CHECK(is_own_origin("http://127.0.0.1:8080", "127.0.0.1:8080"));
  for (const char* foreign : {"", "null", "http://127.0.0.1:8081", "https://127.0.0.1:8080",
                              "http://localhost:8080", "http://127.0.0.1:8080.example.org"}) {
    CAPTURE(foreign);
    CHECK_FALSE(is_own_origin(foreign, "127.0.0.1:8080"));
  }
}

}  // namespace view_access_test
