// SPDX-License-Identifier: Apache-2.0
#include "datasets/scene_painter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace engram::datasets::scene {

namespace {

constexpr int kOversampling = 4;
constexpr int kSubpixelBits = 4;

using Colour = cv::Scalar;  // Red, green, blue.

const Colour kSteel(206, 210, 214);
const Colour kSteelLight(240, 242, 244);
const Colour kDark(46, 50, 58);
const Colour kAccent(232, 112, 36);

Colour mixed(const Colour& a, const Colour& b, double share) {
  return a * (1 - share) + b * share;
}

/// Draws in stage units on a picture of any shape; the stage is centred in it.
class Brush {
 public:
  explicit Brush(cv::Mat& picture)
      : picture_(picture),
        unit_(std::min<double>(picture.rows, picture.cols / kStageWidth)),
        left_((picture.cols - unit_ * kStageWidth) / 2),
        top_((picture.rows - unit_) * 0.6) {}

  [[nodiscard]] double left() const { return -left_ / unit_; }
  [[nodiscard]] double right() const { return (picture_.cols - left_) / unit_; }
  [[nodiscard]] double top() const { return -top_ / unit_; }
  [[nodiscard]] double bottom() const { return (picture_.rows - top_) / unit_; }

  void polygon(std::initializer_list<Point> corners, const Colour& colour) {
    std::vector<cv::Point> points;
    for (const Point corner : corners) points.push_back(at(corner));
    cv::fillConvexPoly(picture_, points, colour, cv::LINE_AA, kSubpixelBits);
  }
  void box(Point from, Point to, const Colour& colour) {
    polygon({from, {to.x, from.y}, to, {from.x, to.y}}, colour);
  }
  void ellipse(Point centre, double rx, double ry, const Colour& colour) {
    cv::ellipse(picture_, at(centre), cv::Size(fixed(rx * unit_), fixed(ry * unit_)), 0, 0, 360,
                colour, cv::FILLED, cv::LINE_AA, kSubpixelBits);
  }
  void circle(Point centre, double radius, const Colour& colour) {
    ellipse(centre, radius, radius, colour);
  }
  /// Draws a bar with round ends of different widths.
  void limb(Point from, Point to, double from_width, double to_width, const Colour& colour) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const Point side{(from.y - to.y) / length / 2, (to.x - from.x) / length / 2};
    polygon({{from.x + side.x * from_width, from.y + side.y * from_width},
             {to.x + side.x * to_width, to.y + side.y * to_width},
             {to.x - side.x * to_width, to.y - side.y * to_width},
             {from.x - side.x * from_width, from.y - side.y * from_width}},
            colour);
    circle(from, from_width / 2, colour);
    circle(to, to_width / 2, colour);
  }
  /// Multiplies the brightness inside an ellipse by `light`.
  void shadow(Point centre, double rx, double ry, double light) {
    const cv::Rect everything(0, 0, picture_.cols, picture_.rows);
    const cv::Rect area =
        pixels({centre.x - rx, centre.y - ry}, {centre.x + rx, centre.y + ry}) & everything;
    if (area.empty()) return;
    cv::Mat region = picture_(area);
    cv::Mat mask(area.size(), CV_8U, cv::Scalar(0));
    cv::ellipse(mask, cv::Point(area.width / 2, area.height / 2),
                cv::Size(area.width / 2, area.height / 2), 0, 0, 360, cv::Scalar(255), cv::FILLED);
    cv::Mat darker;
    region.convertTo(darker, -1, light);
    darker.copyTo(region, mask);
  }
  /// Returns the pixels of a box, clipped to the picture.
  [[nodiscard]] cv::Mat region(Point from, Point to) {
    return picture_(pixels(from, to) & cv::Rect(0, 0, picture_.cols, picture_.rows));
  }

 private:
  static int fixed(double pixels) {
    return static_cast<int>(std::lround(pixels * (1 << kSubpixelBits)));
  }
  [[nodiscard]] cv::Point at(Point point) const {
    return {fixed(left_ + point.x * unit_), fixed(top_ + point.y * unit_)};
  }
  [[nodiscard]] cv::Rect pixels(Point from, Point to) const {
    return {cv::Point(cvRound(left_ + from.x * unit_), cvRound(top_ + from.y * unit_)),
            cv::Point(cvRound(left_ + to.x * unit_), cvRound(top_ + to.y * unit_))};
  }

  cv::Mat picture_;  // Shares its pixels with the argument of the constructor.
  double unit_;
  double left_;
  double top_;
};

/// Adds `columns` x `rows` random spots to all channels of the region alike.
void add_texture(cv::Mat region, cv::RNG& random, int columns, int rows, double sigma) {
  cv::Mat coarse(rows, columns, CV_32F), fine, channels, sum;
  random.fill(coarse, cv::RNG::NORMAL, 0.0, sigma);
  cv::resize(coarse, fine, region.size(), 0, 0, cv::INTER_CUBIC);
  cv::cvtColor(fine, channels, cv::COLOR_GRAY2RGB);
  cv::add(region, channels, sum, cv::noArray(), CV_8U);
  sum.copyTo(region);
}

void fade(cv::Mat region, const Colour& above, const Colour& below) {
  for (int y = 0; y < region.rows; ++y)
    region.row(y).setTo(mixed(above, below, static_cast<double>(y) / std::max(1, region.rows - 1)));
}

void paint_window(Brush& brush, Random& random) {
  const double x = random.between(0.92, 0.98), y = random.between(0.08, 0.12);
  brush.box({x - 0.02, y - 0.02}, {x + 0.30, y + 0.36}, Colour(226, 222, 212));
  fade(brush.region({x, y}, {x + 0.28, y + 0.34}), Colour(126, 176, 222), Colour(206, 226, 236));
  brush.ellipse({x + random.between(0.07, 0.2), y + 0.10}, 0.06, 0.022, Colour(240, 244, 246));
  brush.ellipse({x + random.between(0.07, 0.2), y + 0.13}, 0.045, 0.018, Colour(234, 240, 244));
  fade(brush.region({x, y + 0.27}, {x + 0.28, y + 0.34}), Colour(104, 142, 96),
       Colour(84, 118, 78));
  brush.box({x + 0.132, y}, {x + 0.148, y + 0.34}, Colour(226, 222, 212));
  brush.box({x - 0.03, y + 0.35}, {x + 0.31, y + 0.375}, Colour(204, 198, 186));
}

void paint_shelf(Brush& brush, Random& random) {
  double x = 0.36;
  while (x < 0.78) {
    const double width = random.between(0.018, 0.042);
    const double height = random.between(0.09, 0.15);
    const Colour cover(random.between(60, 200), random.between(60, 160), random.between(60, 180));
    brush.box({x, 0.40 - height}, {x + width, 0.40}, cover);
    brush.box({x, 0.40 - 0.8 * height}, {x + width, 0.40 - 0.68 * height},
              mixed(cover, Colour(255, 255, 255), 0.5));
    x += width + (random.below(5) == 0 ? 0.05 : 0.004);
  }
  brush.box({0.33, 0.40}, {0.82, 0.425}, Colour(122, 92, 66));
  brush.box({0.33, 0.425}, {0.82, 0.432}, Colour(84, 62, 46));
}

void paint_poster(Brush& brush, Random& random) {
  const Point corner{0.05, 0.10};
  brush.box({corner.x - 0.01, corner.y - 0.01}, {corner.x + 0.20, corner.y + 0.27},
            Colour(238, 236, 230));
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 3; ++column) {
      const Colour patch(random.between(40, 230), random.between(40, 200), random.between(50, 220));
      const Point from{corner.x + 0.064 * column, corner.y + 0.066 * row};
      brush.box(from, {from.x + 0.058, from.y + 0.060}, mixed(patch, Colour(150, 140, 128), 0.45));
    }
}

void paint_table(Brush& brush, cv::RNG& noise) {
  const double left = brush.left(), right = brush.right(), edge = 0.885;
  cv::Mat top = brush.region({left, 0.735}, {right, edge});
  fade(top, Colour(156, 116, 78), Colour(186, 144, 100));
  add_texture(top, noise, 12, top.rows / 3, 5.0);
  cv::Mat front = brush.region({left, edge}, {right, brush.bottom()});
  fade(front, Colour(112, 80, 54), Colour(74, 52, 36));
  add_texture(front, noise, 10, std::max(1, front.rows / 3), 4.0);
  brush.box({left, edge - 0.004}, {right, edge + 0.004}, Colour(208, 170, 126));
}

void paint_stand(Brush& brush) {
  const double x = kShoulder.x;
  brush.shadow({x + 0.02, kTableY + 0.015}, 0.17, 0.035, 0.6);
  brush.polygon({{x - 0.10, kTableY + 0.02},
                 {x - 0.06, kTableY - 0.05},
                 {x + 0.06, kTableY - 0.05},
                 {x + 0.10, kTableY + 0.02}},
                kDark);
  brush.polygon({{x - 0.05, kTableY - 0.05},
                 {x - 0.035, kShoulder.y},
                 {x + 0.035, kShoulder.y},
                 {x + 0.05, kTableY - 0.05}},
                Colour(168, 174, 180));
  brush.polygon({{x + 0.01, kTableY - 0.05},
                 {x + 0.005, kShoulder.y},
                 {x + 0.035, kShoulder.y},
                 {x + 0.05, kTableY - 0.05}},
                Colour(136, 142, 150));
  brush.box({x - 0.052, kTableY - 0.07}, {x + 0.052, kTableY - 0.05}, kAccent);
}

void paint_bottle(Brush& brush, Point foot) {
  const Colour body(238, 196, 42), shade(204, 156, 26), light(252, 226, 120), cap(40, 78, 158);
  const double x = foot.x, y = foot.y, r = 0.042;
  brush.ellipse({x, y - 0.006}, r, 0.010, shade);
  brush.box({x - r, y - 0.115}, {x + r, y - 0.006}, body);
  brush.ellipse({x, y - 0.115}, r, 0.032, body);
  brush.box({x - 0.017, y - 0.170}, {x + 0.017, y - 0.13}, body);
  brush.box({x + 0.022, y - 0.115}, {x + r, y - 0.006}, shade);
  brush.box({x - r, y - 0.092}, {x + r, y - 0.042}, Colour(246, 244, 236));
  brush.box({x - r, y - 0.080}, {x + r, y - 0.068}, cap);
  brush.box({x - 0.032, y - 0.120}, {x - 0.022, y - 0.012}, light);
  brush.box({x - 0.021, y - 0.195}, {x + 0.021, y - 0.165}, cap);
}

void paint_box(Brush& brush, Point foot) {
  const Colour face(192, 62, 54), side(142, 40, 40), lid(220, 104, 88);
  const double x = foot.x, y = foot.y, r = 0.055;
  brush.box({x - r, y - 0.105}, {x + r, y}, face);
  brush.polygon({{x - r, y - 0.105},
                 {x - r + 0.02, y - 0.125},
                 {x + r + 0.02, y - 0.125},
                 {x + r, y - 0.105}},
                lid);
  brush.polygon(
      {{x + r, y - 0.105}, {x + r + 0.02, y - 0.125}, {x + r + 0.02, y - 0.02}, {x + r, y}}, side);
  brush.box({x - 0.012, y - 0.105}, {x + 0.012, y}, Colour(236, 214, 168));
  brush.box({x - r, y - 0.04}, {x - 0.025, y - 0.02}, Colour(244, 236, 220));
}

void paint_ball(Brush& brush, Point foot) {
  const double r = 0.052;
  const Point centre{foot.x, foot.y - r};
  const Colour dark(22, 92, 82), light(130, 220, 190);
  constexpr int kRings = 7;
  for (int ring = 0; ring < kRings; ++ring) {
    const double share = static_cast<double>(ring) / (kRings - 1);
    const double shift = 0.35 * r * share;
    brush.circle({centre.x - shift, centre.y - shift}, r * (1 - 0.78 * share),
                 mixed(dark, light, share));
  }
  brush.limb({centre.x - 0.8 * r, centre.y + 0.2 * r}, {centre.x + 0.8 * r, centre.y + 0.2 * r},
             0.012, 0.012, Colour(244, 240, 226));
}

void paint_thing(Brush& brush, size_t kind, Point foot) {
  if (kind == kBottle) paint_bottle(brush, foot);
  if (kind == kBox) paint_box(brush, foot);
  if (kind == kBall) paint_ball(brush, foot);
}

void paint_shadow(Brush& brush, Point foot) {
  const double height = kTableY - foot.y;
  const double spread = 0.062 + 0.05 * height;
  brush.shadow({foot.x + 0.012, kTableY + 0.008}, spread, spread / 4,
               std::min(0.9, 0.58 + 0.6 * height));
}

void paint_joint(Brush& brush, Point centre, double radius) {
  brush.circle(centre, radius, kDark);
  brush.circle(centre, radius * 0.74, kAccent);
  brush.circle(centre, radius * 0.36, kSteelLight);
}

void paint_link(Brush& brush, Point from, Point to, double from_width, double to_width) {
  brush.limb(from, to, from_width + 0.012, to_width + 0.012, kDark);
  brush.limb(from, to, from_width, to_width, kSteel);
  brush.limb({from.x, from.y - from_width / 5}, {to.x, to.y - to_width / 5}, from_width / 3,
             to_width / 3, kSteelLight);
}

void paint_arm(Brush& brush, const Moment& moment) {
  paint_link(brush, kShoulder, moment.elbow, 0.085, 0.062);
  paint_link(brush, moment.elbow, moment.wrist, 0.060, 0.042);
  paint_joint(brush, kShoulder, 0.062);
  paint_joint(brush, moment.elbow, 0.046);
}

void paint_gripper(Brush& brush, const Moment& moment) {
  const Point wrist = moment.wrist;
  const double reach = 0.024 + 0.040 * moment.arm.gripper;
  const double palm = wrist.y + 0.032;
  brush.limb(wrist, {wrist.x, palm}, 0.036, 0.036, kDark);
  brush.limb({wrist.x - reach, palm}, {wrist.x + reach, palm}, 0.022, 0.022, kDark);
  for (const double side : {-1.0, 1.0})
    brush.limb({wrist.x + side * reach, palm}, {wrist.x + side * reach, wrist.y + kFinger + 0.02},
               0.020, 0.014, kDark);
  paint_joint(brush, wrist, 0.032);
}

cv::Mat make_background(const SceneOptions& options) {
  cv::Mat picture(options.height * kOversampling, options.width * kOversampling, CV_8UC3);
  // The constant makes the room independent of the plan, which starts from the same seed.
  Random random(options.seed ^ 0x5eed0f7e87a11e5eULL);
  cv::RNG noise(options.seed * 2 + 1);
  Brush brush(picture);
  const Colour wall(random.between(140, 190), random.between(150, 190), random.between(150, 190));
  fade(picture, mixed(wall, Colour(255, 255, 255), 0.25), mixed(wall, kDark, 0.2));
  add_texture(picture, noise, 9, 7, 4.0);
  paint_poster(brush, random);
  paint_shelf(brush, random);
  paint_window(brush, random);
  paint_table(brush, noise);
  paint_stand(brush);
  add_texture(picture, noise, options.width, options.height, 3.0);
  return picture;
}

}  // namespace

Painter::Painter(const SceneOptions& options)
    : options_(options), background_(make_background(options)) {}

void Painter::paint(const Moment& moment, uint64_t frame, cv::Mat& image) const {
  cv::Mat picture = background_.clone();
  Brush brush(picture);
  for (const Point foot : moment.feet) paint_shadow(brush, foot);
  for (size_t kind = 0; kind < kKinds; ++kind)
    if (moment.held != static_cast<int>(kind)) paint_thing(brush, kind, moment.feet[kind]);
  paint_arm(brush, moment);
  if (moment.held >= 0) {
    const auto held = static_cast<size_t>(moment.held);
    paint_thing(brush, held, moment.feet[held]);
  }
  paint_gripper(brush, moment);

  cv::Mat small, noise(image.size(), CV_16SC3);
  cv::resize(picture, small, image.size(), 0, 0, cv::INTER_AREA);
  // The first numbers of cv::RNG are close for close seeds; large odd factors separate the frames.
  cv::RNG random((options_.seed + 1) * 0x9e3779b97f4a7c15ULL + frame * 0xd1342543de82ef95ULL);
  random.fill(noise, cv::RNG::NORMAL, 0.0, options_.noise_sigma);
  cv::add(small, noise, image, cv::noArray(), CV_8U);
}

}  // namespace engram::datasets::scene
