// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/world.h"

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>

namespace engram::datasets::kitchen {

namespace {

// The stiffness and damping with which joints follow; critically damped. Unit: 1/s^2 and 1/s.
constexpr double kStiffness = 1600;
constexpr double kDamping = 80;

Eigen::Vector3d vector(const mjtNum* from) {
  return {from[0], from[1], from[2]};
}

void write_pose(const Pose& pose, mjtNum* position, mjtNum* turn) {
  const Eigen::Quaterniond rotation(pose.linear());
  for (int i = 0; i < 3; ++i) position[i] = pose.translation()[i];
  turn[0] = rotation.w();
  turn[1] = rotation.x();
  turn[2] = rotation.y();
  turn[3] = rotation.z();
}

Pose pose(const mjtNum* position, const mjtNum* rotation) {
  Pose result = Pose::Identity();
  result.translation() = vector(position);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      result.linear()(row, column) = rotation[3 * row + column];
  return result;
}

}  // namespace

Pose pose_of(const mjData& data, int body) {
  return pose(data.xpos + 3 * body, data.xmat + 9 * body);
}

namespace {

/// MuJoCo's virtual files. The struct is large, so it must live on the heap.
struct Files {
  Files() : vfs(std::make_unique<mjVFS>()) { mj_defaultVFS(vfs.get()); }
  ~Files() { mj_deleteVFS(vfs.get()); }
  std::unique_ptr<mjVFS> vfs;
};

Result<Model> compile(const std::string& document) {
  constexpr const char* kName = "kitchen.xml";
  const Files files;
  const int at = mj_makeEmptyFileVFS(files.vfs.get(), kName, static_cast<int>(document.size()));
  if (at < 0) return unavailable("kitchen: MuJoCo takes no model of {} bytes", document.size());
  std::memcpy(files.vfs->filedata[at], document.data(), document.size());
  std::array<char, 1000> error{};
  Model model(mj_loadXML(kName, files.vfs.get(), error.data(), static_cast<int>(error.size())));
  if (model == nullptr) return unavailable("kitchen: MuJoCo refuses the model: {}", error.data());
  return model;
}

/// Replaces the plain pictures that MuJoCo compiled by textures of the same sizes.
void fill_textures(const std::vector<Texture>& textures, mjModel& model) {
  for (const Texture& texture : textures) {
    const int id = mj_name2id(&model, mjOBJ_TEXTURE, texture.name.c_str());
    ENGRAM_CHECK(id >= 0, "no texture '{}'", texture.name);
    const cv::Mat& pixels = texture.pixels;
    ENGRAM_CHECK(model.tex_width[id] == pixels.cols && model.tex_height[id] == pixels.rows &&
                     pixels.isContinuous(),
                 "texture '{}': {} x {}", texture.name, model.tex_width[id], model.tex_height[id]);
    std::memcpy(model.tex_rgb + model.tex_adr[id], pixels.data, pixels.total() * 3);
  }
}

}  // namespace

Result<World> World::create(const Layout& layout, const DrawingSize& size) {
  World world;
  world.layout_ = layout;
  ModelText text{.is_painted = size.is_painted};
  try {
    add_room(layout, text);
    add_robot(text);
    add_things(layout, text);
    if (layout.has_movables) add_movables(text);
  } catch (const cv::Exception& error) {
    return resource_exhausted("kitchen: cannot paint: {}", error.what());
  }
  ENGRAM_ASSIGN_OR_RETURN(world.model_, compile(document_of(text, size, layout)));
  mjModel* model = world.model_.get();
  fill_textures(text.textures, *model);
  world.data_.reset(mj_makeData(model));
  if (world.data_ == nullptr) return resource_exhausted("kitchen: no memory for its state");
  for (int i = 0; i < kRobotJoints; ++i) {
    const std::string& name = joint_names().at(static_cast<size_t>(i));
    const int joint = mj_name2id(model, mjOBJ_JOINT, name.c_str());
    ENGRAM_CHECK(joint >= 0, "the model has no joint '{}'", name);
    world.dofs_.at(static_cast<size_t>(i)) = model->jnt_dofadr[joint];
    // The robot comes first in the model and its joints have one coordinate each, so indices agree.
    ENGRAM_CHECK(model->jnt_dofadr[joint] == model->jnt_qposadr[joint], "joint '{}'", name);
  }
  for (const Thing& thing : layout.things)
    world.bodies_.push_back(mj_name2id(model, mjOBJ_BODY, std::string(thing.type->name).c_str()));
  if (layout.has_movables)
    for (const ThingClass& type : movable_classes())
      world.movables_.push_back(mj_name2id(model, mjOBJ_BODY, std::string(type.name).c_str()));
  world.torques_.resize(static_cast<size_t>(model->nv));
  world.accelerations_.resize(static_cast<size_t>(model->nv));
  world.place_robot(resting_pose());
  return world;
}

void World::set_robot(const RobotVector& robot, mjData& state) const {
  for (int i = 0; i < kRobotJoints; ++i) state.qpos[dof(i)] = robot[i];
}

void World::place_robot(const RobotVector& robot) {
  set_robot(robot, *data_);
  for (const int dof : dofs_) data_->qvel[dof] = 0;
  mj_forward(model_.get(), data_.get());
}

void World::refresh() {
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_camlight(model_.get(), data_.get());
}

std::pair<double, double> World::range(int joint) const {
  const int id = model_->dof_jntid[dof(joint)];
  if (model_->jnt_limited[id] == 0) return {-1e3, 1e3};
  return {model_->jnt_range[2 * id], model_->jnt_range[2 * id + 1]};
}

void World::step(const Motion& wanted) {
  const mjModel* model = model_.get();
  mjData* data = data_.get();
  mj_step1(model, data);
  std::fill(accelerations_.begin(), accelerations_.end(), 0);
  for (int i = 0; i < kRobotJoints; ++i) {
    const int dof = dofs_[static_cast<size_t>(i)];
    accelerations_[static_cast<size_t>(dof)] = wanted.acceleration[i] +
                                               kDamping * (wanted.velocity[i] - data->qvel[dof]) +
                                               kStiffness * (wanted.position[i] - data->qpos[dof]);
  }
  mj_mulM(model, data, torques_.data(), accelerations_.data());
  for (const int dof : dofs_)
    data->qfrc_applied[dof] =
        torques_[static_cast<size_t>(dof)] + data->qfrc_bias[dof] - data->qfrc_passive[dof];
  mj_step2(model, data);
}

RobotVector World::positions() const {
  RobotVector result;
  for (int i = 0; i < kRobotJoints; ++i) result[i] = data_->qpos[dofs_[static_cast<size_t>(i)]];
  return result;
}

RobotVector World::velocities() const {
  RobotVector result;
  for (int i = 0; i < kRobotJoints; ++i) result[i] = data_->qvel[dofs_[static_cast<size_t>(i)]];
  return result;
}

Pose World::body_pose(const std::string& name) const {
  const int body = mj_name2id(model_.get(), mjOBJ_BODY, name.c_str());
  ENGRAM_CHECK(body >= 0, "the model has no body '{}'", name);
  return pose_of(*data_, body);
}

Pose World::thing_pose(size_t thing) const {
  return pose_of(*data_, bodies_.at(thing));
}

Pose World::movable_pose(size_t movable) const {
  return pose_of(*data_, movables_.at(movable));
}

void World::place_movable(size_t movable, const Pose& at) {
  const int id = model_->body_mocapid[movables_.at(movable)];
  write_pose(at, data_->mocap_pos + 3 * id, data_->mocap_quat + 4 * id);
}

void World::place_thing(size_t thing, const Pose& at) {
  const int joint = model_->body_jntadr[bodies_.at(thing)];
  mjtNum* to = data_->qpos + model_->jnt_qposadr[joint];
  write_pose(at, to, to + 3);
  std::fill_n(data_->qvel + model_->jnt_dofadr[joint], 6, 0);
}

Result<World> World::twin() const {
  World twin;
  twin.layout_ = layout_;
  twin.model_.reset(mj_copyModel(nullptr, model_.get()));
  if (twin.model_ != nullptr) twin.data_.reset(mj_makeData(twin.model_.get()));
  if (twin.data_ == nullptr) return resource_exhausted("kitchen: no memory for a second world");
  twin.dofs_ = dofs_;
  twin.bodies_ = bodies_;
  twin.movables_ = movables_;
  twin.torques_.resize(torques_.size());
  twin.accelerations_.resize(accelerations_.size());
  return twin;
}

std::vector<double> World::coordinates() const {
  const auto moved = static_cast<size_t>(model_->nmocap);
  std::vector<double> all(data_->qpos, data_->qpos + model_->nq);
  all.insert(all.end(), data_->mocap_pos, data_->mocap_pos + 3 * moved);
  all.insert(all.end(), data_->mocap_quat, data_->mocap_quat + 4 * moved);
  return all;
}

void World::set_coordinates(const std::vector<double>& all) {
  const auto own = static_cast<size_t>(model_->nq);
  const auto moved = static_cast<size_t>(model_->nmocap);
  ENGRAM_CHECK(all.size() == own + 7 * moved, "{} coordinates", all.size());
  std::copy_n(all.data(), own, data_->qpos);
  std::copy_n(all.data() + own, 3 * moved, data_->mocap_pos);
  std::copy_n(all.data() + own + 3 * moved, 4 * moved, data_->mocap_quat);
  refresh();
}

Pose World::hand_pose(Side side) const {
  return body_pose(std::string(to_string(side)) + "_hand");
}

Pose World::camera_pose(Side side) const {
  const int camera = mj_name2id(model_.get(), mjOBJ_CAMERA, std::string(to_string(side)).c_str());
  ENGRAM_CHECK(camera >= 0, "the model has no camera '{}'", to_string(side));
  // MuJoCo's cameras have y up and look along -z.
  Pose result = pose(data_->cam_xpos + 3 * camera, data_->cam_xmat + 9 * camera);
  result.linear() = result.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal();
  return result;
}

int World::weld(Side side, size_t thing) const {
  const std::string name =
      std::string(to_string(side)) + ":" + std::string(layout_.things.at(thing).type->name);
  const int id = mj_name2id(model_.get(), mjOBJ_EQUALITY, name.c_str());
  ENGRAM_CHECK(id >= 0, "the model has no link '{}'", name);
  return id;
}

void World::hold(Side side, size_t thing) {
  const Pose pose_hand_thing = hand_pose(side).inverse() * thing_pose(thing);
  const int id = weld(side, thing);
  mjtNum* numbers = model_->eq_data + mjNEQDATA * id;
  std::fill(numbers, numbers + 3, 0);  // The anchor is the middle of the thing.
  write_pose(pose_hand_thing, numbers + 3, numbers + 6);
  model_->eq_active[id] = 1;
  held_[index(side)] = thing;
}

void World::release(Side side) {
  std::optional<size_t>& thing = held_[index(side)];
  if (!thing) return;
  model_->eq_active[weld(side, *thing)] = 0;
  thing.reset();
}

bool World::is_in_sight(size_t thing) const {
  return is_body_in_sight(bodies_.at(thing));
}

bool World::is_movable_in_sight(size_t movable) const {
  return is_body_in_sight(movables_.at(movable));
}

bool World::is_body_in_sight(int body) const {
  const Pose eye = camera_pose(Side::kLeft);
  const Eigen::Vector3d to = pose_of(*data_, body).translation() - eye.translation();
  const double distance = to.norm();
  // The ray tests only geoms that can collide (group 3), so the robot itself does not block it.
  constexpr std::array<mjtByte, mjNGROUP> kSolid{0, 0, 0, 1, 0, 0};
  int geom = -1;
  const double hit = mj_ray(model_.get(), data_.get(), eye.translation().data(), to.data(),
                            kSolid.data(), 1, -1, &geom);
  return geom >= 0 && hit <= 1 && distance > 0 && model_->geom_bodyid[geom] == body;
}

}  // namespace engram::datasets::kitchen
