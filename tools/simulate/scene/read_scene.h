#pragma once

#include "tools/simulate/scene/plan_reader.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// The parts of a plan (config/scenes/README.md): each function fills its members of the scene. They throw
// Error that names the item; whether items fit each other is findFault's question.

// Floors, walls, openings, rooms, furniture, columns, stairs, people, slabs, meshes; `in` is the whole plan.
void readBuilding(const PlanReader& in, Scene& scene);

// `in` is the plan's `path`; the building has been read.
void readPath(const PlanReader& in, Scene& scene);

void readSensor(const PlanReader& in, SensorModel& sensor);
void readLegs(const PlanReader& in, LegsOdometryModel& legs);
void readFaults(const PlanReader& in, FaultModel& faults);

// The member `floor`: an index into the scene's floors.
int readFloor(const PlanReader& in, const Scene& scene);

}  // namespace sgraphs::simulate
