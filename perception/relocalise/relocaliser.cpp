#include "perception/relocalise/relocaliser.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "perception/loops/place_walls.h"
#include "perception/relocalise/candidates.h"
#include "perception/relocalise/known_map.h"

namespace sgraphs {
namespace {

constexpr double kOneHeight_m = 1.0;  // a candidate's height is that of the storey's places
// Of the looks that were taken where the map knows the place, as a candidate has it, so many must prove it: a
// few metres of a corridor may look like those of another building, forty do not.
constexpr double kExplained = 0.5;
// A match that was left out scored at least this share of the best one if the last one that was taken did.
constexpr double kRivalScore = 0.85;

}  // namespace

class Relocaliser::Impl {
 public:
  Impl(const RelocaliseConfig& config, const LoopsConfig& loops, const std::vector<MapView>& map)
      : config_(config), verification_(loops.verification), candidates_(config, loops.verification) {
    std::map<FloorId, std::vector<const MapView*>> storeys;
    for (const MapView& view : map)
      if (view.floor.valid()) storeys[view.floor].push_back(&view);
    for (const auto& [floor, views] : storeys) storeys_.emplace_back(views, loops.place_spacing_m);
  }

  std::optional<Relocalisation> step(const Keyframe& keyframe) {
    follow(keyframe);
    if (keyframe.points.empty() || walked_m_ - searched_m_ < config_.search_spacing_m) return std::nullopt;
    searched_m_ = walked_m_;
    looked_from_.push_back(here().T_odom_body);
    bool complete = true;
    const std::vector<Look> looks = look(complete);
    candidates_.add(looks, here().T_odom_body, walked_m_, complete);
    const Candidate* found = candidates_.found();
    return found && explains(*found) ? std::optional(conclude(*found)) : std::nullopt;
  }

  double walked_m() const { return walked_m_; }
  bool lost() const { return walked_m_ > config_.give_up_m; }

  std::string describe() const {
    const auto& all = candidates_.all();
    if (all.empty()) return "no place of the map looks like what was seen last";
    const Look& best = all.front().looks.back();
    std::string text = "at " + best.anchor.str() + " of the map, proven by " +
                       std::to_string(all.front().looks.size()) + " look(s)";
    if (all.size() > 1) text += "; " + std::to_string(all.size() - 1) + " other place(s) look alike";
    return text;
  }

 private:
  // A keyframe of the new session.
  struct Step {
    KeyframeId id;
    double walked_m = 0;
    SE3 T_odom_body;
    SE3 T_first_body;                        // by the measurements alone
    Matrix6d covariance = Matrix6d::Zero();  // of that, as steps that all err alike
    std::optional<Place> place;              // while it is on the newest path
  };
  const Step& here() const { return path_.back(); }

  void follow(const Keyframe& keyframe) {
    Step step;
    step.id = keyframe.id;
    step.T_odom_body = keyframe.T_odom_body;
    if (!path_.empty()) {
      const Step& last = here();
      const SE3 T_last_body = last.T_odom_body.inverse() * keyframe.T_odom_body;
      walked_m_ += T_last_body.translation.norm();
      steps_covariance_ = composeCovariance(steps_covariance_, T_last_body, covarianceOf(keyframe, last.id));
    }
    step.walked_m = walked_m_;
    step.T_first_body = path_.empty() ? SE3() : path_.front().T_odom_body.inverse() * keyframe.T_odom_body;
    // No sum of n errors has more than n times the sum of their covariances.
    step.covariance = static_cast<double>(std::max<size_t>(1, path_.size())) * steps_covariance_;
    if (!up_known_ && !keyframe.up_body.isZero(0.0)) {
      up_known_ = true;
      R_level_odom_ = Eigen::Quaterniond::FromTwoVectors(step.T_odom_body.rotation * keyframe.up_body,
                                                         Eigen::Vector3d::UnitZ());
    }
    if (!keyframe.points.empty()) step.place.emplace(keyframe);
    path_.push_back(std::move(step));
    for (Step& old : path_)
      if (walked_m_ - old.walked_m > verification_.query_path_m) old.place.reset();
  }

  // Of the step from the last keyframe: the odometry's, else any measurement's; else as legs err.
  static Matrix6d covarianceOf(const Keyframe& keyframe, KeyframeId last) {
    const RelativePose* best = nullptr;
    for (const RelativePose& z : keyframe.relative_poses)
      if (z.from == last && (!best || z.kind == RelativePoseKind::kOdometry)) best = &z;
    if (best) return best->covariance;
    Vector6d variance;
    variance << Eigen::Vector3d::Constant(0.05 * 0.05), Eigen::Vector3d::Constant(0.02 * 0.02);
    return variance.asDiagonal();
  }

  std::vector<PlacedPlace> query() const {
    const SE3 T_here_odom = here().T_odom_body.inverse();
    std::vector<PlacedPlace> out;
    for (auto step = path_.rbegin(); step != path_.rend(); ++step)
      if (step->place) out.push_back({&*step->place, T_here_odom * step->T_odom_body});
    return out;
  }

  // Where the walls fit, and where the candidates say that the robot is: one look at each.
  std::vector<Look> look(bool& complete) const {
    const std::vector<PlacedPlace> query = this->query();
    const Eigen::Quaterniond R_level_body = R_level_odom_ * here().T_odom_body.rotation;
    const std::vector<WallPoint> walls = wallsAround(query, R_level_body);
    struct Match {
      const KnownStorey* storey;
      LayoutMatch at;
    };
    std::vector<Match> matches;
    for (const KnownStorey& storey : storeys_)
      for (const LayoutMatch& m : storey.search(walls, config_.max_matches)) matches.push_back({&storey, m});
    std::stable_sort(matches.begin(), matches.end(),
                     [](const Match& a, const Match& b) { return a.at.score > b.at.score; });
    const auto max = static_cast<size_t>(config_.max_matches);
    if (matches.size() > max) matches.resize(max);
    complete = matches.size() < max || matches.back().at.score < kRivalScore * matches.front().at.score;

    Looker looker{*this, query, {}, {}};
    for (const Match& m : matches) {
      const KnownPlace* anchor = m.storey->nearest(m.at.position_map, kAnchorReach_m);
      if (!anchor) continue;
      // A body is carried at one height above the floor.
      looker.check(*m.storey, *anchor,
                   {so3Exp({0, 0, m.at.yaw_rad}) * R_level_body,
                    {m.at.position_map.x(), m.at.position_map.y(), anchor->T_map_body.translation.z()}});
    }
    for (const Candidate& c : candidates_.all()) lookAt(c, looker);
    std::stable_sort(looker.looks.begin(), looker.looks.end(),
                     [](const Look& a, const Look& b) { return a.check.quality() > b.check.quality(); });
    std::vector<Look> kept;
    for (const Look& l : looker.looks)
      if (std::all_of(kept.begin(), kept.end(), [&](const Look& k) {
            return areDistinct(k.T_map_odom * here().T_odom_body, l.T_map_odom * here().T_odom_body);
          }))
        kept.push_back(l);
    return kept;
  }

  // Registers at guesses; the surroundings of an anchor are made once.
  struct Looker {
    const Impl& owner;
    const std::vector<PlacedPlace>& query;
    std::map<const KnownPlace*, OldSurroundings> surroundings;
    std::vector<Look> looks;

    void check(const KnownStorey& storey, const KnownPlace& anchor, const SE3& T_map_guess) {
      auto it = surroundings.find(&anchor);
      if (it == surroundings.end())
        it = surroundings.emplace(&anchor, storey.surroundingsOf(anchor, owner.verification_.submap_radius_m))
                 .first;
      Look look;
      look.anchor = anchor.place.id;
      look.keyframe = owner.here().id;
      look.at_m = owner.walked_m_;
      look.check =
          checkLoop(query, it->second, anchor.T_map_body.inverse() * T_map_guess, owner.verification_);
      look.T_map_odom = anchor.T_map_body * look.check.T_anchor_body * owner.here().T_odom_body.inverse();
      looks.push_back(look);
    }
  };

  // Where no match led to.
  void lookAt(const Candidate& c, Looker& looker) const {
    const SE3& T_odom_body = here().T_odom_body;
    for (const Look& l : looker.looks)
      if (Candidates::same(c, l.T_map_odom, T_odom_body, walked_m_)) return;
    const SE3 T_map_body = c.T_map_odom * T_odom_body;
    for (const KnownStorey& storey : storeys_) {
      const KnownPlace* anchor = placeAt(T_map_body, storey);
      if (!anchor) continue;
      return looker.check(storey, *anchor, T_map_body);
    }
  }

  const KnownPlace* placeAt(const SE3& T_map_body, const KnownStorey& storey) const {
    const KnownPlace* place = storey.nearest(T_map_body.translation.head<2>(), kAnchorReach_m);
    const bool level =
        place && std::abs((place->T_map_body.translation - T_map_body.translation).z()) <= kOneHeight_m;
    return level ? place : nullptr;
  }

  // The walk so far, not only its end, is one through the map.
  bool explains(const Candidate& c) const {
    const auto known = std::count_if(looked_from_.begin(), looked_from_.end(), [&](const SE3& T_odom_body) {
      return std::any_of(storeys_.begin(), storeys_.end(), [&](const KnownStorey& storey) {
        return placeAt(c.T_map_odom * T_odom_body, storey) != nullptr;
      });
    });
    return static_cast<double>(c.looks.size()) >= kExplained * static_cast<double>(known);
  }

  // By the look that knows the session's beginning best.
  Relocalisation conclude(const Candidate& found) const {
    Relocalisation r;
    r.first = path_.front().id;
    r.T_map_odom = found.T_map_odom;
    r.walked_m = walked_m_;
    r.looks = static_cast<int>(found.looks.size());
    double best = 0;
    for (const Look& look : found.looks) {
      const auto step =
          std::find_if(path_.begin(), path_.end(), [&](const Step& s) { return s.id == look.keyframe; });
      const SE3 T_body_first = step->T_first_body.inverse();
      // The inverse of what was measured from the first keyframe to this one.
      const Matrix6d Ad = se3Adjoint(step->T_first_body);
      const Matrix6d covariance =
          composeCovariance(look.check.covariance, T_body_first, Ad * step->covariance * Ad.transpose());
      if (r.anchor.valid() && covariance.trace() >= best) continue;
      best = covariance.trace();
      r.anchor = look.anchor;
      r.matched = look.keyframe;
      r.T_anchor_first = look.check.T_anchor_body * T_body_first;
      r.covariance = covariance;
    }
    return r;
  }

  RelocaliseConfig config_;
  LoopVerificationConfig verification_;
  std::vector<KnownStorey> storeys_;
  Candidates candidates_;
  std::deque<Step> path_;
  Matrix6d steps_covariance_ = Matrix6d::Zero();
  std::vector<SE3> looked_from_;  // T_odom_body of each look
  double walked_m_ = 0;
  double searched_m_ = 0;
  bool up_known_ = false;
  Eigen::Quaterniond R_level_odom_ = Eigen::Quaterniond::Identity();
};

Relocaliser::Relocaliser(const RelocaliseConfig& config, const LoopsConfig& loops,
                         const std::vector<MapView>& map)
    : impl_(std::make_unique<Impl>(config, loops, map)) {}
Relocaliser::~Relocaliser() = default;

std::optional<Relocalisation> Relocaliser::step(const Keyframe& keyframe) {
  return impl_->step(keyframe);
}

double Relocaliser::walked_m() const {
  return impl_->walked_m();
}

bool Relocaliser::lost() const {
  return impl_->lost();
}

std::string Relocaliser::describe() const {
  return impl_->describe();
}

}  // namespace sgraphs
