#pragma once

#include "tools/eval/evaluate.h"
#include "tools/eval/report_parts.h"

// Rooms, floors and doorways in table and eval.json. A layer that was not judged has null where its figures
// would be, and the reason.
namespace sgraphs::report {

std::string roomLines(const RoomResult& rooms);
std::string floorLines(const FloorResult& floors, const std::vector<StoreyError>& by_storey);
std::string doorwayLines(const DoorwayResult& doorways);

Json roomsJson(const RoomResult& rooms);
Json floorsJson(const FloorResult& floors, const std::vector<StoreyError>& by_storey);
Json doorwaysJson(const DoorwayResult& doorways);

}  // namespace sgraphs::report
