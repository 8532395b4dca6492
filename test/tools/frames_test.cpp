// make_bag frames: the URDF and the transform of a calibrated pair.
#include "programs.hpp"

namespace fpga_stereo::tools {
namespace {

class Frames : public ProgramTest {
 protected:
  Frames() {
    InfoPair cameras = distorted_cameras({160, 120});
    cameras.right.P[3] = -0.0625 * cameras.right.P[0];
    write_info("left.yaml", cameras.left);
    write_info("right.yaml", cameras.right);
  }
  Outcome frames(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"frames", "--left-info", at("left.yaml"), "--right-info",
                                       "file://" + at("right.yaml")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return make_bag(arguments);
  }
};

TEST_F(Frames, UrdfHasTheBaselineOfTheCalibration) {
  const Outcome run = frames();
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, R"(<?xml version="1.0"?>
<robot name="stereo">
  <link name="stereo_link" />
  <joint name="stereo_left_optical_frame_joint" type="fixed">
    <origin xyz="0 0 0" rpy="-1.5707963268 0 -1.5707963268" />
    <parent link="stereo_link" />
    <child link="stereo_left_optical_frame" />
  </joint>
  <link name="stereo_left_optical_frame" />
  <joint name="stereo_right_optical_frame_joint" type="fixed">
    <origin xyz="0.062500 0 0" rpy="0 0 0" />
    <parent link="stereo_left_optical_frame" />
    <child link="stereo_right_optical_frame" />
  </joint>
  <link name="stereo_right_optical_frame" />
</robot>
)");
}

TEST_F(Frames, UrdfHasAMountAndOtherNames) {
  const Outcome run = frames({"--camera", "front", "--frame-id", "cam0", "--parent", "base_link",
                              "--xyz", "0.3 0 0.25", "--rpy", "0 0.1 0"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.out.find(R"(<robot name="front">
  <link name="base_link" />
  <joint name="front_link_joint" type="fixed">
    <origin xyz="0.3 0 0.25" rpy="0 0.1 0" />
    <parent link="base_link" />
    <child link="front_link" />
  </joint>
  <link name="front_link" />
  <joint name="cam0_joint" type="fixed">)"),
            std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find(R"(<child link="front_right_optical_frame" />)"), std::string::npos);
}

TEST_F(Frames, TransformIsWhatTheStaticPublisherReads) {
  const Outcome run = frames({"--format", "transform", "--camera", "rear"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, R"(header: {frame_id: rear_left_optical_frame}
child_frame_id: rear_right_optical_frame
transform:
  translation: {x: 0.062500, y: 0.0, z: 0.0}
  rotation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}
)");
}

TEST_F(Frames, RefusesWhatItCannotUse) {
  expect_refused("make_bag", frames({"--format", "xacro"}), 2,
                 {"--format xacro", "urdf and transform"});
  expect_refused("make_bag", frames({"--camera", "<front>"}), 2, {"--camera \"<front>\""});
  expect_refused("make_bag", frames({"--xyz", "1 2"}), 2, {"--xyz \"1 2\"", "three numbers"});
  expect_refused("make_bag", make_bag({"frames", "--left-info", at("left.yaml")}), 2,
                 {"right-info"});
  expect_refused(
      "make_bag",
      make_bag({"frames", "--left-info", at("left.yaml"), "--right-info", at("left.yaml")}), 1,
      {"P[3] = 0"});
  expect_refused("make_bag",
                 make_bag({"frames", "--left-info", at("none.yaml"), "--right-info",
                           "http://camera/right.yaml"}),
                 1, {"none.yaml"});
  expect_refused("make_bag",
                 make_bag({"frames", "--left-info", "http://camera/left.yaml", "--right-info",
                           at("right.yaml")}),
                 1, {"http://camera/left.yaml", "file:///PATH"});
}

}  // namespace
}  // namespace fpga_stereo::tools
