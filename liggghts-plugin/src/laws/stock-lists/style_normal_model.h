// Which stock normal models laws/law_styles.cpp combines with; read several times, so without a guard.
