#include "engine/executor/tbb/edge_board.hpp"

#include "engine/executor/tbb/edge_board_protocol.hpp"

namespace cvtflow::engine {

template class EdgeBoardOn<BoardMachine>;

}  // namespace cvtflow::engine
