// Models from URDF: against models built in code and closed forms; and repaired input, with the
// line of its note.
#include "vphysics/multibody/urdf.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cstdio>
#include <fstream>
#include <locale>
#include <thread>

#include "urdf_text.h"
#include "vphysics/multibody/constrained_dynamics.h"

namespace vp::test {
namespace {

SE3 pose_at(const Model& model, const std::vector<double>& q, const char* link) {
  Data data(model);
  const std::vector<double> v(static_cast<std::size_t>(model.velocities()));
  forward_kinematics<double>(model, data, q, v);
  return T_world_link(model, data, model.find_link(link));
}
double distance(const SE3& a, const SE3& b) {
  double worst = norm(a.position() - b.position());
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      worst = std::max(worst, std::fabs(a.rotation()(i, k) - b.rotation()(i, k)));
    }
  }
  return worst;
}
SE3 turn(const Vec3& axis, double angle) {
  return SE3(Exp(angle * axis), {});
}

// --- models

TEST(Urdf, AnArmIsTheModelBuiltByHand) {
  const UrdfModel read = must_parse(
      robot("<link name=\"base\"/>\n"
            "<link name=\"upper\"><inertial><origin xyz=\"0.1 0.2 0.3\" rpy=\"0.4 -0.5 0.6\"/>"
            "<mass value=\"2.5\"/><inertia ixx=\"0.3\" ixy=\"0.01\" ixz=\"0.02\" iyy=\"0.4\" "
            "iyz=\"-0.03\" izz=\"0.5\"/></inertial></link>\n" +
            body("lower") +
            joint("shoulder", "revolute", "base", "upper",
                  "<origin xyz=\"0 0 0.5\" rpy=\"0.1 0.2 0.3\"/><axis xyz=\"0 2 0\"/>"
                  "<dynamics damping=\"0.7\"/>" +
                      kLimit) +
            joint("slide", "prismatic", "upper", "lower",
                  "<origin xyz=\"0.3 0 0\"/><axis xyz=\"1 1 0\"/>" + kLimit)));

  const auto rpy = [](double r, double p, double y) {
    return turn({0, 0, 1}, y) * turn({0, 1, 0}, p) * turn({1, 0, 0}, r);
  };
  ModelBuilder builder;
  must_build(builder.add({}));
  LinkSpec upper;
  upper.parent = 0;
  upper.joint = RevoluteJoint{{0, 1, 0}};
  upper.T_parent_joint = SE3(Vec3{0, 0, 0.5}) * rpy(0.1, 0.2, 0.3);
  upper.damping = 0.7;
  // From the frame of the principal axes to the link's frame.
  const SE3 T = SE3(Vec3{0.1, 0.2, 0.3}) * rpy(0.4, -0.5, 0.6);
  upper.inertia = Inertia(2.5, {}, {0.3, 0.4, 0.5, 0.01, -0.03, 0.02}).Xform(Inv(T));
  must_build(builder.add(upper));
  LinkSpec lower;
  lower.parent = 1;
  lower.joint = PrismaticJoint{{1, 1, 0}};
  lower.T_parent_joint = SE3(Vec3{0.3, 0, 0});
  lower.inertia = Inertia(2.0, Vec3{0.3, 0.4, 0.5});
  must_build(builder.add(lower));
  const Model by_hand = must_build(builder.build());

  ASSERT_EQ(read.model.velocities(), 2);
  const std::vector<double> q{0.3, -0.4}, v{0.5, 0.6}, tau{0.7, -0.8};
  std::vector<double> a(2), b(2);
  Data data(read.model), data_by_hand(by_hand);
  ASSERT_TRUE(forward_dynamics<double>(read.model, data, q, v, tau, {}, a));
  ASSERT_TRUE(forward_dynamics<double>(by_hand, data_by_hand, q, v, tau, {}, b));
  EXPECT_LT(largest_difference(a, b), 1e-13 * largest_of(b));
}

TEST(Urdf, EveryTypeOfJointMovesAsTheFormatSays) {
  const Vec3 axis{0.6, 0, 0.8};
  const std::string text_of_axis = "<axis xyz=\"0.6 0 0.8\"/>";
  const auto pose = [&](const std::string& type, const std::vector<double>& q) {
    const UrdfModel read = must_parse(one_joint(type, text_of_axis + kLimit));
    EXPECT_EQ(static_cast<std::size_t>(read.model.coordinates()), q.size()) << type;
    return pose_at(read.model, q, "b");
  };
  EXPECT_LT(distance(pose("revolute", {0.7}), turn(axis, 0.7)), 1e-15);
  EXPECT_LT(distance(pose("continuous", {7.0}), turn(axis, 7.0)), 1e-15);
  EXPECT_LT(distance(pose("prismatic", {0.7}), SE3(0.7 * axis)), 1e-15);
  const Quaternion q = to_quaternion(Exp(Vec3{0.1, 0.2, 0.3}));
  EXPECT_LT(distance(pose("floating", {1, 2, 3, q.x, q.y, q.z, q.w}),
                     SE3(Exp(Vec3{0.1, 0.2, 0.3}), {1, 2, 3})),
            1e-15);
}

TEST(Urdf, WithoutAnAxisItIsX) {
  const UrdfModel read = must_parse(one_joint("continuous", ""));
  EXPECT_LT(distance(pose_at(read.model, {0.7}, "b"), turn({1, 0, 0}, 0.7)), 1e-15);
}

// Two directions perpendicular to the axis span the plane. The joint chooses which two.
TEST(Urdf, APlanarJointStaysInThePlaneAcrossItsAxis) {
  for (const Vec3& axis : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{0.48, 0.64, 0.6}}) {
    char text[100];
    std::snprintf(text, sizeof text, "<axis xyz=\"%.17g %.17g %.17g\"/>", axis.x, axis.y, axis.z);
    const UrdfModel read = must_parse(one_joint("planar", text));
    ASSERT_EQ(read.model.coordinates(), 3);
    ASSERT_EQ(read.joints.size(), 1u);
    EXPECT_EQ(read.model.first_coordinate(read.joints[0].link), 0);
    EXPECT_LT(distance(pose_at(read.model, {0, 0, 0}, "b"), SE3()), 1e-15);
    const SE3 slid = pose_at(read.model, {0.3, 0.4, 0}, "b");
    EXPECT_NEAR(dot(slid.position(), axis), 0.0, 1e-15);
    EXPECT_NEAR(norm(slid.position()), 0.5, 1e-15);
    EXPECT_LT(distance(pose_at(read.model, {0, 0, 0.7}, "b"), turn(axis, 0.7)), 1e-15);
  }
}

TEST(Urdf, AFloatingBaseFalls) {
  UrdfOptions options;
  options.base = UrdfBase::floating;
  options.T_world_root = SE3(Vec3{0, 0, 5});
  const UrdfModel read = must_parse(robot(body("b")), options);
  ASSERT_EQ(read.model.velocities(), 6);
  const std::vector<double> q = read.model.zero_coordinates(), zero(6);
  EXPECT_EQ(pose_at(read.model, q, "b").position(), (Vec3{0, 0, 5}));
  std::vector<double> a(6);
  Data data(read.model);
  ASSERT_TRUE(forward_dynamics<double>(read.model, data, q, zero, zero, {}, a));
  EXPECT_NEAR(a[5], -9.81, 1e-14);
}

TEST(Urdf, LinksStandInTheOrderOfTheJointsParentsFirst) {
  const UrdfModel read = must_parse(robot(
      body("leaf") + body("root") + body("z") + body("a") + joint("4", "continuous", "a", "leaf") +
      joint("3", "continuous", "root", "z") + joint("1", "continuous", "root", "a")));
  std::string order;
  for (int i = 0; i < read.model.links(); ++i) order += read.model.link(i).name + " ";
  EXPECT_EQ(order, "root z a leaf ");
  ASSERT_EQ(read.joints.size(), 3u);
  for (const UrdfJoint& each : read.joints) {
    const char* carried = each.name == "4" ? "leaf" : each.name == "3" ? "z" : "a";
    EXPECT_EQ(read.model.link(each.link).name, carried);
    EXPECT_EQ(read.find_joint(each.name), &each);
  }
  EXPECT_EQ(read.find_joint("2"), nullptr);
}

TEST(Urdf, AJointTellsItsLimitsFrictionAndMimic) {
  const UrdfModel read =
      must_parse(robot(body("base") + body("b") + body("c") +
                       joint("j", "revolute", "base", "b",
                             "<limit lower=\"-1.5\" upper=\"+2.5e0\" effort=\"30\" velocity=\"4\"/>"
                             "<dynamics friction=\"0.25\"/>") +
                       joint("k", "continuous", "b", "c",
                             "<mimic joint=\"j\" multiplier=\"-2\" offset=\"0.5\"/><dynamics/>")));
  const UrdfJoint& j = *read.find_joint("j");
  EXPECT_EQ(j.lower, -1.5);
  EXPECT_EQ(j.upper, 2.5);
  EXPECT_EQ(j.effort, 30.0);
  EXPECT_EQ(j.velocity, 4.0);
  EXPECT_EQ(j.friction, 0.25);
  EXPECT_EQ(j.mimics, "");
  const UrdfJoint& k = *read.find_joint("k");
  EXPECT_EQ(k.mimics, "j");
  EXPECT_EQ(k.multiplier, -2.0);
  EXPECT_EQ(k.offset, 0.5);
  EXPECT_EQ(k.upper, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(read.notes.empty());

  // The model has the limits, too, and the coupling holds where k follows j.
  const JointForces& forces = read.model.link(j.link).forces.at(0);
  EXPECT_EQ(forces.lower, -1.5);
  EXPECT_EQ(forces.upper, 2.5);
  EXPECT_EQ(forces.motor_limit, 30.0);
  EXPECT_EQ(forces.friction, 0.25);
  ConstrainedData data(read.model, must_build(ConstraintSet::make(read.model, read.couplings)));
  const std::vector<double> rest(2);
  std::vector<double> q(2);
  q[static_cast<std::size_t>(read.model.first_coordinate(j.link))] = 0.7;
  q[static_cast<std::size_t>(read.model.first_coordinate(k.link))] = -2 * 0.7 + 0.5;
  evaluate_constraints(read.model, data, q, rest);
  ASSERT_EQ(data.residual().size(), 1u);
  EXPECT_NEAR(data.residual()[0], 0.0, 1e-15);
  q[0] += 0.1;
  evaluate_constraints(read.model, data, q, rest);
  EXPECT_GT(std::fabs(data.residual()[0]), 0.05);
}

TEST(Urdf, WhatIsLeftOutIsTold) {
  const UrdfModel read = must_parse(
      robot(
          "<material name=\"m\"/>\n<link name=\"b\" colour=\"red\">\n<visual><geometry><mesh "
          "filename=\"x.dae\"/></geometry></visual>\n<collision/><visual/>words<!-- more -->\n"
          "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
          "izz=\"1\"/></inertial></link>\n<gazebo/>\n"),
      {UrdfBase::floating, {}});
  const std::vector<std::string> notes{
      "line 5: a <collision> without geometry is left out", "line 7: <gazebo> of <robot> left out",
      "line 2: <material> of <robot> left out", "line 4: <visual> of <link> left out, 2 in all",
      "line 3: attribute \"colour\" of <link> left out"};
  EXPECT_EQ(read.notes, notes);
}

// --- repaired input

struct Mended {
  std::string text;
  const char* note;  // without the line number
};
// Expects exactly one note, and forward dynamics that inverts inverse dynamics.
UrdfModel expect_mended(const Mended& mended, int line, UrdfBase base = UrdfBase::fixed) {
  UrdfModel read = must_parse(mended.text, {base, {}});
  EXPECT_EQ(read.notes.size(), 1u) << mended.note;
  const std::string note = read.notes.empty() ? "" : read.notes.front();
  EXPECT_EQ(note.rfind("line " + std::to_string(line) + ": ", 0), 0u) << note;
  EXPECT_NE(note.find(mended.note), std::string::npos) << note;
  const auto n = static_cast<std::size_t>(read.model.velocities());
  Data data(read.model);
  const std::vector<double> q = read.model.zero_coordinates(), v(n, 0.3), wanted(n, 0.7);
  std::vector<double> tau(n), a(n);
  inverse_dynamics<double>(read.model, data, q, v, wanted, {}, tau);
  EXPECT_TRUE((forward_dynamics<double>(read.model, data, q, v, tau, {}, a))) << mended.note;
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(a[i], 0.7, 1e-8) << mended.note;
  return read;
}

TEST(UrdfMended, JointsAreToldByLine) {
  const std::string good = body("base") + body("b");  // lines 2 and 3
  const auto with = [&](const std::string& type, const std::string& more) {
    return robot(good + joint("j", type, "base", "b", "\n" + more));  // joint on 4, more on 5
  };
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto j = [&](const Mended& mended, int line) {
    return *expect_mended(mended, line).find_joint("j");
  };
  const UrdfJoint free = j({with("revolute", ""), "has no <limit>"}, 4);
  EXPECT_EQ(free.lower, -kNever);
  EXPECT_EQ(free.upper, kNever);
  EXPECT_EQ(free.effort, kNever);
  EXPECT_EQ(free.velocity, kNever);
  const UrdfJoint fast =
      j({with("prismatic", "<limit upper=\"2\" effort=\"3\"/>"), "velocity is not given"}, 5);
  EXPECT_EQ(fast.velocity, kNever);
  EXPECT_EQ(fast.effort, 3.0);
  EXPECT_EQ(fast.upper, 2.0);
  EXPECT_EQ(j({with("prismatic", "<limit effort=\"-1\" velocity=\"1\"/>"), "effort is negative"}, 5)
                .effort,
            kNever);
  const UrdfJoint turned = j(
      {with("revolute", "<limit lower=\"1\" upper=\"-2\" effort=\"1\" velocity=\"1\"/>"), "above"},
      5);
  EXPECT_EQ(turned.lower, -2.0);
  EXPECT_EQ(turned.upper, 1.0);
  EXPECT_EQ(
      j({with("continuous", "<dynamics friction=\"-1\"/>"), "friction is negative"}, 5).friction,
      0.0);
  for (const char* mimic : {"<mimic joint=\"k\"/>", "<mimic joint=\"j\"/>"}) {
    EXPECT_EQ(j({with("continuous", mimic), "mimics is left out"}, 5).mimics, "");
  }
  EXPECT_EQ(j({with("floating", "<mimic joint=\"l\"/>"), "mimics is left out"}, 5).mimics, "");
  (void)j({with("continuous", "<origin xyz=\"0 0 1\"/><origin xyz=\"0 0 2\"/>"),
           "second <origin> of <joint> left out"},
          5);
}

TEST(UrdfMended, AMimicInACircleIsOpenedOnce) {
  const UrdfModel read = must_parse(
      robot(body("base") + body("b") + body("c") +
            joint("j", "continuous", "base", "b", "<mimic joint=\"k\" multiplier=\"2\"/>") +
            joint("k", "continuous", "b", "c", "<mimic joint=\"j\"/>")));
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_NE(read.notes[0].find("circle"), std::string::npos) << read.notes[0];
  EXPECT_EQ(read.couplings.size(), 1u);
}

// Parts of a file without effect are not read, and there is no note about them.
TEST(UrdfMended, TheAxisOfAFixedJointIsNotRead) {
  for (const char* axis : {"<axis xyz=\"0 0 0\"/>", "<axis/>", "<axis xyz=\"a\"/>"}) {
    const UrdfModel read =
        must_parse(robot(body("a") + body("b") + body("c") + joint("j", "fixed", "a", "b", axis) +
                         joint("k", "continuous", "b", "c")));
    EXPECT_TRUE(read.notes.empty()) << axis;
  }
  EXPECT_EQ(
      std::get<RevoluteJoint>(
          expect_mended({one_joint("continuous", "<axis/>"), "taken as x"}, 4).model.link(1).joint)
          .axis,
      (Vec3{1, 0, 0}));
}

std::string with_inertial(const std::string& mass, const std::string& moments,
                          const std::string& type = "continuous") {
  return robot(body("base") + "<link name=\"b\"><inertial>\n<mass value=\"" + mass +
               "\"/>\n<inertia " + moments + "/></inertial></link>\n" +
               joint("j", type, "base", "b", kLimit));
}

// The inertia that acts on the only joint, at zero.
double mass_felt(const UrdfModel& read) {
  Data data(read.model);
  std::vector<double> M(1);
  mass_matrix<double>(read.model, data, read.model.zero_coordinates(), M);
  return M[0];
}

TEST(UrdfMended, InertiasThatNoBodyHasAreTakenAsStated) {
  // Rounded, or rotated wrongly: one moment is larger than the sum of the others.
  const UrdfModel flat = expect_mended(
      {with_inertial("1", "ixx=\"3\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\""),
       "more than the two others"},
      3);
  EXPECT_DOUBLE_EQ(mass_felt(flat), 3.0);
  // A link without a body, as files use it for a frame.
  const UrdfModel massless = expect_mended(
      {with_inertial("0", "ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\""),
       "moments and no mass"},
      3);
  EXPECT_DOUBLE_EQ(mass_felt(massless), 1e-3);
  expect_mended({with_inertial("1e-6",
                               "ixx=\"1e-6\" ixy=\"1e-6\" ixz=\"1e-6\" iyy=\"1e-6\" "
                               "iyz=\"1e-6\" izz=\"1e-6\""),
                 "more than the two others"},
                3);
  // Principal moments 3 and -1 in the xy plane.
  const UrdfModel negative = expect_mended(
      {with_inertial("1", "ixx=\"1\" ixy=\"2\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\""),
       "negative, and taken as zero"},
      3);
  EXPECT_NEAR(mass_felt(negative), 1.5, 1e-14) << "half of the moment 3 about the diagonal";
  // Missing products of inertia are zero.
  const UrdfModel short_one = must_parse(with_inertial("1", "ixx=\"1\" iyy=\"1\" izz=\"1\""));
  EXPECT_EQ(short_one.notes.size(), 3u);
}

TEST(UrdfMended, AJointThatMovesNoMassIsGivenAnArmature) {
  const std::string nothing = "<link name=\"b\"/>\n";
  const auto armature = [](const Mended& mended, int line, UrdfBase base = UrdfBase::fixed) {
    return expect_mended(mended, line, base).model.link(1).armature;
  };
  // The base of 2 kg, the link 0.5 m away.
  EXPECT_DOUBLE_EQ(
      armature({robot(body("base") + nothing +
                      joint("j", "continuous", "base", "b", "<origin xyz=\"0 0.5 0\"/>")),
                "moves no mass"},
               3),
      1e-6 * 2 * 0.25);
  EXPECT_DOUBLE_EQ(
      armature({robot(body("base") + nothing + joint("j", "prismatic", "base", "b", kLimit)),
                "moves no mass"},
               3),
      1e-6 * 2);
  // A point mass on its axis; a wheel on a massless base that can rotate with it.
  EXPECT_GT(
      armature({with_inertial("1", "ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\""),
                "moves no mass"},
               3),
      0.0);
  const UrdfModel wheel =
      expect_mended({one_joint("continuous", ""), "moves no mass"}, 2, UrdfBase::floating);
  EXPECT_GT(wheel.model.link(0).armature, 0.0);
  EXPECT_EQ(wheel.model.link(1).armature, 0.0);
}

TEST(UrdfMended, ARobotWithoutANameAndZeroBytesAtItsEnd) {
  std::string text = one_joint("continuous", "");
  text.replace(text.find(" name=\"r\""), 9, "");
  EXPECT_EQ(expect_mended({text, "no name"}, 1).name, "");
  text = one_joint("continuous", "") + std::string(3, '\0');
  EXPECT_TRUE(must_parse(text).notes.empty());
}

// --- files, locales, output, threads

TEST(UrdfFile, IsReadAsItsTextIs) {
  const std::string path = testing::TempDir() + "vphysics_urdf_test.urdf";
  std::ofstream(path) << one_joint("continuous", "");
  const UrdfModel read = must_build(load_urdf(path));
  EXPECT_EQ(read.model.velocities(), 1);
  std::ofstream(path) << "<robot name=\"r\">\n<link/>\n</robot>";
  EXPECT_EQ(load_urdf(path).error().message,
            path + ": line 2: <link> needs the attribute \"name\"");
  std::remove(path.c_str());
  for (const std::string& none : {path, testing::TempDir(), std::string()}) {
    EXPECT_NE(load_urdf(none).error().message.find("cannot be read"), std::string::npos) << none;
  }
  EXPECT_EQ(load_urdf("/dev/zero").error().code, Errc::unsupported);
}

struct CommaForPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Urdf, NumbersReadTheSameInEveryLocale) {
  const std::string text =
      robot("<link name=\"base\"/>\n" + body("b") +
            joint("j", "continuous", "base", "b", "<origin xyz=\"1234.5 -0.25 1e-3\"/>"));
  const std::locale before = std::locale::global(std::locale(std::locale(), new CommaForPoint));
  const char* named = std::setlocale(LC_ALL, "de_DE.UTF-8");  // if it is installed
  const auto read = parse_urdf(text);
  std::locale::global(before);
  if (named) std::setlocale(LC_ALL, "C");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->model.link(1).T_parent_joint.position(), (Vec3{1234.5, -0.25, 1e-3}));
  EXPECT_EQ(read->model.link(1).inertia.rotational().xx, 0.3);
}

TEST(Urdf, NothingIsPrinted) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  (void)parse_urdf(one_joint("revolute", kLimit));
  (void)parse_urdf(one_joint("revolute", ""));
  (void)parse_urdf("<robot name=\"r\"");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Urdf, ManyThreadsMayReadAtOnce) {
  const std::string text = one_joint("planar", "");
  std::array<bool, 4> good{};
  std::vector<std::thread> threads;
  threads.reserve(good.size());
  for (bool& each : good) {
    threads.emplace_back([&] {
      each = true;
      for (int i = 0; i < 50; ++i) each = parse_urdf(text).has_value() && each;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, (std::array{true, true, true, true}));
}

}  // namespace
}  // namespace vp::test
