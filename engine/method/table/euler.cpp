#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

StagePlan euler() {
    return butcher_plan("euler", "explicit Euler method", "Euler, Institutionum calculi integralis I (1768) 424-425", {}, {1.0});
}

}  // namespace cvtflow::engine
