// Which stock surface models laws/law_styles.cpp combines with; read several times, so without a guard.
#include <surface_model_default.h>
