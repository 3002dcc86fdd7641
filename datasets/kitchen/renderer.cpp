// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/kitchen/gl_context.h"

namespace engram::datasets::kitchen {

namespace {

constexpr int kMaxGeoms = 2000;
constexpr float kNear_m = 0.03f;
constexpr float kFar_m = 12.0f;

void set_vector(float* to, const Eigen::Vector3d& from) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

/// Frame of `pose`: x right, y down, z forward.
mjvGLCamera camera_at(const Pose& pose) {
  mjvGLCamera camera{};
  set_vector(camera.pos, pose.translation());
  set_vector(camera.forward, pose.linear().col(2));
  set_vector(camera.up, -pose.linear().col(1));
  camera.frustum_near = kNear_m;
  camera.frustum_far = kFar_m;
  camera.frustum_top = kNear_m * static_cast<float>(std::tan(0.5 * kFieldOfView_rad));
  camera.frustum_bottom = -camera.frustum_top;
  return camera;
}

/// Returns the columns from..from + width of an image whose rows are stored from bottom to top.
idf::NdArray cut(const std::vector<uint8_t>& pixels, int full_width, int height, int from,
                 int width) {
  std::vector<uint8_t> result(static_cast<size_t>(width) * static_cast<size_t>(height) * 3);
  for (int y = 0; y < height; ++y) {
    const auto row = static_cast<size_t>(height - 1 - y) * static_cast<size_t>(full_width);
    std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>((row + static_cast<size_t>(from)) * 3),
                width * 3, result.begin() + static_cast<std::ptrdiff_t>(y) * width * 3);
  }
  return idf::NdArray::take({height, width, 3}, std::move(result));
}

}  // namespace

Pinhole Pinhole::of(const DrawingSize& size) {
  return {.focal = 0.5 * size.height / std::tan(0.5 * kFieldOfView_rad),
          .centre_x = 0.5 * size.width - 0.5,
          .centre_y = 0.5 * size.height - 0.5};
}

bool Pinhole::shows(const Eigen::Vector3d& point_m, const DrawingSize& size) const {
  if (point_m.z() <= 0) return false;
  const Eigen::Vector2d at = project(point_m);
  return at.x() >= 0 && at.y() >= 0 && at.x() <= size.width - 1 && at.y() <= size.height - 1;
}

struct Renderer::Parts {
  ~Parts() {
    mjr_freeContext(&context);
    mjv_freeScene(&scene);
  }

  std::unique_ptr<GlContext> gl;
  DrawingSize size;
  mjvScene scene{};
  mjrContext context{};
  mjvOption option{};
  std::vector<uint8_t> pixels;
  std::vector<float> depth;
};

Renderer::Renderer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::create(const World& world, const DrawingSize& size) {
  auto parts = std::make_unique<Parts>();
  parts->size = size;
  mjv_defaultScene(&parts->scene);
  mjr_defaultContext(&parts->context);
  mjv_defaultOption(&parts->option);
  ENGRAM_ASSIGN_OR_RETURN(parts->gl, GlContext::create());
  const mjModel* model = &world.model();
  mjv_makeScene(model, &parts->scene, kMaxGeoms);
  mjr_makeContext(model, &parts->context, mjFONTSCALE_50);
  mjr_setBuffer(mjFB_OFFSCREEN, &parts->context);
  if (parts->context.currentBuffer != mjFB_OFFSCREEN)
    return unavailable("kitchen: OpenGL draws into no memory; needs framebuffer objects");
  const mjrRect max = mjr_maxViewport(&parts->context);
  if (max.width < 2 * size.width || max.height < size.height)
    return unavailable("kitchen: OpenGL draws {} x {} pixels at most, needs {} x {}", max.width,
                       max.height, 2 * size.width, size.height);
  // Group 3 has the collision shapes, which must not be seen.
  parts->option.geomgroup[3] = 0;
  parts->scene.flags[mjRND_SHADOW] = size.shadow_map > 0;
  parts->scene.flags[mjRND_REFLECTION] = 0;
  parts->scene.flags[mjRND_HAZE] = 0;
  parts->scene.flags[mjRND_SKYBOX] = 0;
  const auto count = static_cast<size_t>(2 * size.width) * static_cast<size_t>(size.height);
  parts->pixels.resize(3 * count);
  parts->depth.resize(count);
  return std::unique_ptr<Renderer>(new Renderer(std::move(parts)));
}

void Renderer::update(const World& world) {
  mjvCamera unused;
  mjv_defaultCamera(&unused);
  mjvScene& scene = parts_->scene;
  mjv_updateScene(&world.model(), &world.data(), &parts_->option, nullptr, &unused, mjCAT_ALL,
                  &scene);
  scene.stereo = mjSTEREO_SIDEBYSIDE;
  scene.camera[0] = camera_at(world.camera_pose(Side::kLeft));
  scene.camera[1] = camera_at(world.camera_pose(Side::kRight));
}

void Renderer::render(int width) {
  mjr_render({0, 0, width, parts_->size.height}, &parts_->scene, &parts_->context);
}

StereoPicture Renderer::draw(const World& world, bool with_depth) {
  const DrawingSize& size = parts_->size;
  const int full = 2 * size.width;
  update(world);
  render(full);
  mjr_readPixels(parts_->pixels.data(), with_depth ? parts_->depth.data() : nullptr,
                 {0, 0, full, size.height}, &parts_->context);
  StereoPicture picture{cut(parts_->pixels, full, size.height, 0, size.width),
                        cut(parts_->pixels, full, size.height, size.width, size.width),
                        {}};
  if (!with_depth) return picture;
  picture.depth_mm.reserve(static_cast<size_t>(size.width) * static_cast<size_t>(size.height));
  for (int y = size.height - 1; y >= 0; --y)
    for (int x = 0; x < size.width; ++x) {
      const auto at = static_cast<size_t>(y) * static_cast<size_t>(full) + static_cast<size_t>(x);
      // OpenGL's depth is not linear; this inverts the projection with both clipping planes.
      const double metres =
          kNear_m / (1.0 - parts_->depth[at] * (1.0 - static_cast<double>(kNear_m) / kFar_m));
      picture.depth_mm.push_back(
          static_cast<uint16_t>(std::clamp(std::round(1000 * metres), 0.0, 65535.0)));
    }
  return picture;
}

std::pair<idf::NdArray, idf::NdArray> Renderer::draw_mask(const World& world, size_t thing) {
  update(world);
  mjvScene& scene = parts_->scene;
  const int body = mj_name2id(&world.model(), mjOBJ_BODY,
                              std::string(world.layout().things.at(thing).type->name).c_str());
  // Keep only the geoms of the thing, in white that does not depend on the light.
  int kept = 0;
  for (int i = 0; i < scene.ngeom; ++i) {
    const mjvGeom& geom = scene.geoms[i];
    if (geom.objtype != mjOBJ_GEOM || world.model().geom_bodyid[geom.objid] != body) continue;
    scene.geoms[kept] = geom;
    scene.geoms[kept].texid = -1;
    std::fill_n(scene.geoms[kept].rgba, 4, 1.0f);
    scene.geoms[kept].emission = 1;
    ++kept;
  }
  scene.ngeom = kept;
  const int full = 2 * parts_->size.width;
  render(full);
  mjr_readPixels(parts_->pixels.data(), nullptr, {0, 0, full, parts_->size.height},
                 &parts_->context);
  const auto mask_from = [&](int from) {
    const idf::NdArray cut_out =
        cut(parts_->pixels, full, parts_->size.height, from, parts_->size.width);
    const auto rgb = cut_out.values<uint8_t>();
    std::vector<uint8_t> mask(rgb.size() / 3);
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = rgb[3 * i] > 127 ? 255 : 0;
    return idf::NdArray::take({parts_->size.height, parts_->size.width, 1}, std::move(mask));
  };
  return {mask_from(0), mask_from(parts_->size.width)};
}

idf::NdArray Renderer::draw_from(const World& world, const Eigen::Vector3d& eye,
                                 const Eigen::Vector3d& target) {
  update(world);
  Pose pose = Pose::Identity();
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  pose.linear() << right, forward.cross(right), forward;
  pose.translation() = eye;
  parts_->scene.stereo = mjSTEREO_NONE;
  // Without stereo, MuJoCo averages the two cameras, so both get the same pose.
  parts_->scene.camera[0] = parts_->scene.camera[1] = camera_at(pose);
  const int full = 2 * parts_->size.width;
  render(full);
  mjr_readPixels(parts_->pixels.data(), nullptr, {0, 0, full, parts_->size.height},
                 &parts_->context);
  return cut(parts_->pixels, full, parts_->size.height, 0, full);
}

}  // namespace engram::datasets::kitchen
