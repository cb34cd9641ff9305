// URDF that is rejected: the line and the reason.
#include <gtest/gtest.h>
#include <pthread.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "urdf_text.h"

namespace vp::test {
namespace {

struct Broken {
  std::string text;
  int line;
  const char* reason;
};
void expect_refused(const Broken& broken) {
  const auto read = parse_urdf(broken.text);
  ASSERT_FALSE(read) << broken.reason << "\n" << broken.text.substr(0, 500);
  EXPECT_EQ(read.error().code, Errc::bad_data);
  const std::string& message = read.error().message;
  EXPECT_EQ(message.rfind("line " + std::to_string(broken.line) + ": ", 0), 0u)
      << message << "\nwanted: line " << broken.line;
  EXPECT_NE(message.find(broken.reason), std::string::npos) << message;
}

TEST(UrdfRefusal, OfWhatIsNoXmlNamesTheLine) {
  for (const Broken& broken : std::vector<Broken>{
           {"", 1, "there is no element"},
           {" \n ", 1, "there is no element"},
           {"<?xml version=\"1.0\"?>\n<!-- nothing -->\n", 1, "there is no element"},
           {"words", 1, "XML"},
           {"<robot name=\"r\">\n<link name=\"a\">\n</robot>", 2, "closed"},
           {"<robot name=\"r\">\n<link name=\"a\"/>\n", 1, "closed"},
           {"<robot name=\"r\">\n<link name=a/>\n</robot>", 2, "attribute"},
           {"<robot name=\"r\">\n<link name=\"a/>\n</robot>", 2, "attribute"},
           {"<robot name=\"r\">\n<!-- \n</robot>", 2, "comment"},
           {std::string("<robot>\n\0</robot>", 17), 2, "zero byte"},
       }) {
    expect_refused(broken);
  }
}

TEST(UrdfRefusal, OfElementsAndAttributesNamesTheLine) {
  const std::string good = body("base") + body("b");  // lines 2 and 3
  const auto with = [&](const std::string& type, const std::string& more) {
    return robot(good + joint("j", type, "base", "b", "\n" + more));  // joint on 4, more on 5
  };
  std::string many_attributes = "<!-- \" --><![CDATA[<a b=\"]]><visual";
  for (int i = 0; i <= 200; ++i) many_attributes += " a" + std::to_string(i) + "='>'";
  many_attributes += "/>";
  const auto inertial = [](const std::string& inside) {
    return robot("<link name=\"a\">\n<inertial>\n" + inside + "</inertial></link>\n");
  };
  const std::string inertia =
      "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>\n";
  for (const Broken& broken : std::vector<Broken>{
           {"<sdf/>", 1, "the root element is <sdf>"},
           {"<robot name=\"r\" version=\"2.0\"><link name=\"a\"/></robot>", 1, "version \"2.0\""},
           {robot(""), 1, "no link"},
           {robot("<link/>"), 2, "needs the attribute \"name\""},
           {robot("<link name=\"a\"/>\n<link name=\"a\"/>"), 3, "line 2 already"},
           {robot("<link name=\"a&#10;b\"/>"), 2, "control character"},
           {robot("<link name=\"a\"\nname=\"b\"/>"), 3, "stands twice"},
           {robot("<link name=\"a\">\n" + many_attributes + "</link>"), 3, "more than 200"},
           {inertial(inertia), 3, "needs a <mass>"},
           {inertial("<mass value=\"1\"/>"), 3, "needs a <inertia>"},
           {inertial("<mass/>" + inertia), 4, "needs the attribute \"value\""},
           {inertial("<mass value=\"heavy\"/>" + inertia), 4, "value=\"heavy\" of <mass>"},
           {inertial("<mass value=\"\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"1 2\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"1,5\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"0x10\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"nan\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"inf\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"1e999\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"+-1\"/>" + inertia), 4, "no finite number"},
           {inertial("<mass value=\"-1\"/>" + inertia), 4, "negative"},
           {inertial("<mass value=\"1\"/>\n<inertia ixx=\"1\"/>"), 5, "needs the attribute"},
           {inertial("<origin xyz=\"1 2\"/>"), 4, "is not 3 finite numbers"},
           {inertial("<origin rpy=\"1 2 3 4\"/>"), 4, "is not 3 finite numbers"},
           {robot(good + "<joint name=\"j\"/>"), 4, "needs the attribute \"type\""},
           {with("hinge", ""), 4, "type \"hinge\""},
           {with("continuous", "<axis xyz=\"0 0 0\"/>"), 5, "no length"},
           {with("continuous", "<axis xyz=\"0 0 1e-200\"/>"), 5, "no length"},
           {with("continuous", "<mimic/>"), 5, "needs the attribute \"joint\""},
           {with("continuous", "<parent link=\"b\"/>"), 5, "second <parent>"},
           {with("continuous", "<origin xyz=\"a b c\"/>"), 5, "\"a b c\""},
           {robot(good + "<joint name=\"j\" type=\"fixed\"><parent link=\"b\"/></joint>"), 4,
            "needs a <child>"},
           {robot(good + "<joint name=\"j\" type=\"fixed\"><child link=\"b\"/></joint>"), 4,
            "needs a <parent>"},
           {robot(good + "<joint name=\"j\" type=\"fixed\"><parent/></joint>"), 4,
            "needs the attribute \"link\""},
       }) {
    expect_refused(broken);
  }
}

TEST(UrdfRefusal, OfLinksThatAreNoTreeNamesTheLine) {
  const std::string abc = body("a") + body("b") + body("c");  // lines 2 to 4
  for (const Broken& broken : std::vector<Broken>{
           {robot(abc + joint("j", "fixed", "a", "d")), 5, "child link \"d\""},
           {robot(abc + joint("j", "fixed", "d", "a")), 5, "parent link \"d\""},
           {robot(abc + joint("j", "fixed", "a", "b")), 4, "two links have no parent"},
           {robot(body("a") + joint("j", "fixed", "a", "a")), 3, "circle"},
           {robot(abc + joint("j", "fixed", "b", "c") + joint("k", "fixed", "c", "b")), 6,
            "circle"},
           {robot(body("b") + body("c") + joint("j", "fixed", "b", "c") +
                  joint("k", "fixed", "c", "b")),
            5, "circle"},
           {robot(abc + joint("j", "fixed", "a", "b") + joint("k", "fixed", "a", "c") +
                  joint("l", "fixed", "b", "c")),
            7, "has a parent already, by the joint on line 6"},
           {robot(abc + joint("j", "fixed", "a", "b") + joint("j", "fixed", "a", "c")), 6,
            "line 5 already"},
           {robot(body("a")), 1, "no joint of the robot moves"},
       }) {
    expect_refused(broken);
  }
}

// Runs the work with a stack of 256 KiB: recursion as deep as the text overflows it.
void on_a_small_stack(const std::function<void()>& work) {
  pthread_attr_t small;
  pthread_attr_init(&small);
  ASSERT_EQ(pthread_attr_setstacksize(&small, 256 * 1024), 0);
  pthread_t thread{};
  const auto run = [](void* given) -> void* {
    (*static_cast<const std::function<void()>*>(given))();
    return nullptr;
  };
  ASSERT_EQ(
      pthread_create(&thread, &small, run, const_cast<void*>(static_cast<const void*>(&work))), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&small);
}

TEST(UrdfRefusal, OfWhatIsTooMuchNeedsNoStack) {
  std::string deep = "<robot name=\"r\">";
  for (int i = 0; i < 200000; ++i) deep += "<link>";
  // The links of urdfdom own each other, here ten thousand deep. With names in this order it would
  // free them recursively.
  constexpr int kLinks = 10000;
  const auto name = [](int i) { return std::to_string(kLinks + i); };
  std::string chain = body(name(0));
  for (int i = 1; i < kLinks; ++i) {
    chain += body(name(i)) + joint(name(i), "continuous", name(i - 1), name(i));
  }
  on_a_small_stack([&] {
    EXPECT_NE(parse_urdf(deep).error().message.find("100 deep"), std::string::npos);
    EXPECT_EQ(must_parse(robot(chain)).model.velocities(), kLinks - 1);
  });
  EXPECT_EQ(parse_urdf(std::string((16u << 20) + 1, ' ')).error().code, Errc::unsupported);
}

TEST(UrdfRefusal, OfAFileThatEndsEarlyNamesALineInIt) {
  const std::string text = one_joint("revolute", kLimit);
  for (std::size_t size = 0; size + 2 < text.size(); ++size) {
    const auto read = parse_urdf(text.substr(0, size));
    ASSERT_FALSE(read) << size;
    int line = 0;
    ASSERT_EQ(std::sscanf(read.error().message.c_str(), "line %d: ", &line), 1);
    ASSERT_GE(line, 1);
    ASSERT_LE(line, 5);
  }
}

TEST(UrdfRefusal, OfARootThatStandsNowhere) {
  UrdfOptions options;
  options.T_world_root = SE3(Vec3{std::nan(""), 0, 0});
  EXPECT_EQ(parse_urdf(one_joint("continuous", ""), options).error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace vp::test
