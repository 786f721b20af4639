// The kernels of rigid pins in floats behind a state in doubles, as a step takes them.
#define CVTFLOW_RIGID_NUMBER float
#include "model/rigid/rigid_kernels.cpp"
