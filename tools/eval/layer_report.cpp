#include "tools/eval/layer_report.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace sgraphs::report {
namespace {

template <typename Number>
Json orNull(const std::optional<Number>& number) {
  return number ? Json(*number) : Json(nullptr);
}

std::string shareCell(size_t part, size_t whole) {
  const auto share = shareOf(part, whole);
  return share ? format("%.3f", *share) : "-";
}

std::string missingLine(const char* layer, const std::string& why, size_t asked) {
  const bool in_truth = why.rfind("missing", 0) == 0;
  return format("%-9s ", layer) + (in_truth ? "" : "not judged: ") + why +
         (in_truth ? format("; the truth asks for %zu", asked) : "") + "\n";
}

// "what: a, b, c", empty if there is none.
std::string listLine(const char* layer, const char* what, const std::vector<std::string>& items) {
  std::string line;
  for (const std::string& item : items) line += (line.empty() ? "" : ", ") + item;
  return line.empty() ? line : format("%-9s %s: ", layer, what) + line + "\n";
}

std::vector<std::string> missedRooms(const RoomResult& rooms) {
  std::vector<std::string> missed;
  for (const auto& room : rooms.truth)
    if (room.asked && !room.estimate) missed.push_back(room.id);
  return missed;
}

// Of rooms or floors.
template <typename Result>
std::vector<std::string> falseOnes(const Result& result) {
  std::vector<std::string> ids;
  for (const auto& estimate : result.estimates)
    if (!estimate.why_false.empty()) ids.push_back(estimate.id + " (" + estimate.why_false + ")");
  return ids;
}

std::string detectionLine(const RoomResult& rooms) {
  if (!rooms.num_long_visits) return {};
  const std::string of =
      format("%zu rooms occupied for %.0f s or more", rooms.num_long_visits, RoomResult::kLongVisit_s);
  if (!rooms.detection_s)
    return "rooms     time to detection missing in this run: no utime at any of " + of + "\n";
  return format("rooms     time to detection median %.1f s, max %.1f s, over %zu of ",
                rooms.detection_s->median, rooms.detection_s->max, rooms.detection_s->count) +
         of + "\n";
}

std::string storeyName(const FloorResult& floors, std::optional<size_t> storey) {
  return storey ? format("storey %zu (%.2f m)", *storey, floors.storeys[*storey].z_m) : "between storeys";
}

std::string countCell(const DoorwayResult::Count& count) {
  return format("%zu of %zu", count.found, count.asked);
}

Json trueRoomJson(const RoomResult& rooms, const RoomResult::Truth& room) {
  Json json{{"id", room.id}, {"asked", room.asked}, {"inside_s", room.visit.inside_s}};
  json["estimate"] = room.estimate ? Json(rooms.estimates[*room.estimate].id) : Json(nullptr);
  json["iou"] = room.estimate ? Json(room.iou) : Json(nullptr);
  json["area_error_m2"] = room.estimate ? Json(room.area_error_m2) : Json(nullptr);
  json["detection_s"] = orNull(room.detection_s);
  return json;
}

template <typename Result>
Json falseJson(const Result& result) {
  Json list = Json::array();
  for (const auto& estimate : result.estimates)
    if (!estimate.why_false.empty()) list.push_back({{"id", estimate.id}, {"why", estimate.why_false}});
  return list;
}

Json countJson(const DoorwayResult::Count& count) {
  return {
      {"asked", count.asked}, {"found", count.found}, {"recall", orNull(shareOf(count.found, count.asked))}};
}

Json storeyErrorsJson(const std::vector<StoreyError>& by_storey) {
  Json list = Json::array();
  for (const StoreyError& error : by_storey)
    list.push_back({{"storey", orNull(error.storey)}, {"ate_m", statisticsJson(error.translation_m)}});
  return list;
}

// With null for each figure.
Json missingJson(const std::string& why, size_t asked, std::initializer_list<const char*> figures) {
  Json json{{"missing", why}, {"asked", asked}};
  for (const char* figure : figures) json[figure] = nullptr;
  return json;
}

Json storeyJson(const FloorResult& floors, size_t s) {
  const FloorResult::Storey& storey = floors.storeys[s];
  return {{"z_m", storey.z_m},
          {"walked_s", storey.walked_s},
          {"asked", floors.asked(s)},
          {"estimate", storey.estimate ? Json(floors.estimates[*storey.estimate].id) : Json(nullptr)},
          {"height_error_m", orNull(storey.height_error_m)}};
}

}  // namespace

std::string format(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

Json statisticsJson(const ErrorStatistics& s) {
  return {{"count", s.count}, {"rmse", s.rmse}, {"median", s.median}, {"max", s.max}};
}

std::string roomLines(const RoomResult& rooms) {
  if (!rooms.missing.empty()) return missingLine("rooms", rooms.missing, rooms.num_asked);
  std::string lines =
      format("rooms     %zu asked for: %zu found, %zu missed; %zu in the graph, %zu of them false; ",
             rooms.num_asked, rooms.num_found, rooms.num_asked - rooms.num_found, rooms.estimates.size(),
             rooms.num_false);
  lines += "recall " + shareCell(rooms.num_found, rooms.num_asked) + ", precision " +
           shareCell(rooms.num_true, rooms.num_true + rooms.num_false);
  if (rooms.num_found)
    lines += format("; mean IoU %.3f, area off by %.2f m2 in the median, %.2f at most", rooms.mean_iou,
                    rooms.area_error_m2.median, rooms.area_error_m2.max);
  return lines + "\n" + listLine("rooms", "missed", missedRooms(rooms)) +
         listLine("rooms", "false", falseOnes(rooms)) + detectionLine(rooms);
}

std::string floorLines(const FloorResult& floors, const std::vector<StoreyError>& by_storey) {
  std::string lines;
  if (!floors.missing.empty()) {
    lines = missingLine("floors", floors.missing, floors.numAsked());
  } else {
    lines = format("floors    %zu asked for: %zu found, %zu missed; %zu in the graph, %zu of them false",
                   floors.numAsked(), floors.numFound(), floors.numAsked() - floors.numFound(),
                   floors.estimates.size(), floors.numFalse());
    for (size_t s = 0; s < floors.storeys.size(); ++s)
      if (floors.asked(s) && floors.storeys[s].estimate)
        lines += "; " + storeyName(floors, s) +
                 (floors.storeys[s].height_error_m ? format(": %+.3f m", *floors.storeys[s].height_error_m)
                                                   : std::string(" without a height"));
    lines += "\n" + listLine("floors", "false", falseOnes(floors));
  }
  std::vector<std::string> errors;
  errors.reserve(by_storey.size());
  for (const StoreyError& error : by_storey)
    errors.push_back(storeyName(floors, error.storey) +
                     format(" %.4f m (%zu poses)", error.translation_m.rmse, error.translation_m.count));
  lines += listLine("floors", "ATE", errors);
  if (floors.by_lift > 0)
    lines += format(
        "floors    %zu reached by lift only, whose height nothing measures: moved to where it is before all "
        "else was judged, the rides left out\n",
        floors.by_lift);
  return lines;
}

std::string doorwayLines(const DoorwayResult& doorways) {
  if (!doorways.missing.empty())
    return missingLine("doorways", doorways.missing, doorways.of_asked_rooms.asked);
  std::string lines = "doorways  found: walked through " + countCell(doorways.walked_through) +
                      ", of rooms asked for " + countCell(doorways.of_asked_rooms) + ", all " +
                      countCell(doorways.all) +
                      format("; %zu in the graph, %zu of them false; precision ", doorways.estimates.size(),
                             doorways.num_false) +
                      shareCell(doorways.all.found, doorways.estimates.size());
  if (doorways.all.found)
    lines +=
        format("; off by %.2f m in the median, %.2f at most, width by %.2f, %.2f", doorways.distance_m.median,
               doorways.distance_m.max, doorways.width_error_m.median, doorways.width_error_m.max);
  return lines + "\n";
}

Json roomsJson(const RoomResult& rooms) {
  if (!rooms.missing.empty())
    return missingJson(rooms.missing, rooms.num_asked,
                       {"found", "recall", "precision", "mean_iou", "area_error_m2", "detection_s"});
  Json all = Json::array();
  for (const RoomResult::Truth& room : rooms.truth) all.push_back(trueRoomJson(rooms, room));
  Json json{{"in_graph", rooms.estimates.size()}, {"asked", rooms.num_asked}, {"found", rooms.num_found}};
  json["recall"] = orNull(shareOf(rooms.num_found, rooms.num_asked));
  json["precision"] = orNull(shareOf(rooms.num_true, rooms.num_true + rooms.num_false));
  json["mean_iou"] = rooms.num_found ? Json(rooms.mean_iou) : Json(nullptr);
  json["area_error_m2"] = rooms.num_found ? statisticsJson(rooms.area_error_m2) : Json(nullptr);
  json["missed"] = missedRooms(rooms);
  json["false"] = falseJson(rooms);
  json["detection_s"] = rooms.detection_s ? statisticsJson(*rooms.detection_s) : Json(nullptr);
  json["detection_asked"] = rooms.num_long_visits;
  if (!rooms.detection_s)
    json["detection_missing"] = rooms.num_long_visits
                                    ? "no room that was occupied for 15 s or more is found with a utime"
                                    : "no room was occupied for 15 s or more";
  json["rooms"] = std::move(all);
  return json;
}

Json floorsJson(const FloorResult& floors, const std::vector<StoreyError>& by_storey) {
  Json json;
  if (!floors.missing.empty()) {
    json = missingJson(floors.missing, floors.numAsked(), {"found", "recall", "precision"});
  } else {
    json = {
        {"in_graph", floors.estimates.size()}, {"asked", floors.numAsked()}, {"found", floors.numFound()}};
    json["recall"] = orNull(shareOf(floors.numFound(), floors.numAsked()));
    json["precision"] = orNull(shareOf(floors.estimates.size() - floors.numFalse(), floors.estimates.size()));
    json["false"] = falseJson(floors);
    json["storeys"] = Json::array();
    for (size_t s = 0; s < floors.storeys.size(); ++s) json["storeys"].push_back(storeyJson(floors, s));
  }
  if (floors.by_lift > 0) json["by_lift"] = floors.by_lift;
  if (!by_storey.empty()) json["ate_by_storey"] = storeyErrorsJson(by_storey);
  return json;
}

Json doorwaysJson(const DoorwayResult& doorways) {
  if (!doorways.missing.empty())
    return missingJson(
        doorways.missing, doorways.of_asked_rooms.asked,
        {"walked_through", "of_asked_rooms", "all", "precision", "distance_m", "width_error_m"});
  const bool any = doorways.all.found > 0;
  return {{"in_graph", doorways.estimates.size()},
          {"walked_through", countJson(doorways.walked_through)},
          {"of_asked_rooms", countJson(doorways.of_asked_rooms)},
          {"all", countJson(doorways.all)},
          {"false", doorways.num_false},
          {"precision", orNull(shareOf(doorways.all.found, doorways.estimates.size()))},
          {"distance_m", any ? statisticsJson(doorways.distance_m) : Json(nullptr)},
          {"width_error_m", any ? statisticsJson(doorways.width_error_m) : Json(nullptr)}};
}

}  // namespace sgraphs::report
