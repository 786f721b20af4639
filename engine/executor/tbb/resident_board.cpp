#include "engine/executor/tbb/resident_board.hpp"

#include "engine/executor/tbb/resident_board_protocol.hpp"

namespace cvtflow::engine {

template class ResidentBoardOn<BoardMachine>;

}  // namespace cvtflow::engine
