#include "protocol_doc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "wire/read_file.h"

namespace wire::test {
namespace {

TEST(ProtocolDocument, TheCommittedOneIsTheOneThatTheCodeDescribes) {
  const auto committed = read_file(WIRE_PROTOCOL_MD, 1 << 20);
  ASSERT_TRUE(committed.has_value()) << committed.error();
  const std::string made = protocol_document();
  const auto bytes = std::as_bytes(std::span(made));
  EXPECT_TRUE(std::ranges::equal(*committed, bytes))
      << "docs/protocol.md is out of date. Renew it:\n  ninja -C build/release wire_protocol_doc "
         "&& "
         "build/release/bin/wire_protocol_doc docs/protocol.md";
}

TEST(ProtocolDocument, NamesEveryMessage) {
  const std::string made = protocol_document();
  for (const char* part :
       {"men[].position", "rods[].driven", "### 1 Hello", "### 2 Welcome", "### 3 Refusal",
        "### 4 MatchRequest", "### 5 Ping", "### 6 Pong", "### 7 Notice", "### 8 Bye",
        "### keyframe", "### 21 Phones", "### pulse", "4 team_taken", "CRC-16/CCITT-FALSE"}) {
    EXPECT_NE(made.find(part), std::string::npos) << part;
  }
}

}  // namespace
}  // namespace wire::test
