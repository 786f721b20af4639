"""`cvtflow clamp`: clamping forces of best efficiency at a margin of slip."""

from . import reduce
from ._front import between

DESCRIPTION = "Find the clamping forces of best efficiency at a margin of slip, as a table for a controller"
FOOTER = "The table has the clamping forces of best efficiency that keep the margin, beside those of clamping.safety."


def declare(parser):
    reduce.declare(parser, "clamp", "table and picture")
    parser.add_argument("--margin", metavar="NUMBER", type=between(float, 0.0, 3.0), default=0.1,
                        help="Torque that remains to the limit of slip, as a share of the load (default: 0.1)")


def act(given):
    request = reduce.request_of(given, "clamp", given.margin)
    from .._clamp import clamp

    return reduce.carried_out(clamp, request)
